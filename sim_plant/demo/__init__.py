"""The main job shown from outside: both programs as processes, then a judgement and a report."""

__all__ = [
    "evaluation",
    "live",
    "loop",
    "processes",
    "report",
    "session",
    "unusual_plants",
    "wires",
]
