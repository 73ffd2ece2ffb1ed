"""What the service and its runs report: status, metrics, comparisons, weeks of a line."""

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
    "watch_notes",
    "watching",
]
