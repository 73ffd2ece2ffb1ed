"""What the screen keeps of the line, and the pages that show it: alarms, events, rolls, trends."""

__all__ = ["alarm_desk", "data_routes", "kept"]
