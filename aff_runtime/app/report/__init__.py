"""A record of the ring as text, with units."""

__all__ = [
    "alarm_table",
    "block_status",
    "command_counts",
    "comparison",
    "line_facts",
    "metrics",
    "probe_facts",
    "roll_page",
    "run_export",
    "status",
    "status_answer",
    "tick_row",
    "watching",
]
