"""What the screen keeps of the line, and the pages that show it: alarms, events, rolls, trends."""

__all__ = [
    "alarm",
    "alarm_book",
    "alarm_desk",
    "alarm_part",
    "data_routes",
    "events",
    "journal",
    "kept",
    "store",
]
