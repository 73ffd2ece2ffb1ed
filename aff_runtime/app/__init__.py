"""Wiring: the one place where rooms meet."""

__all__ = [
    "card",
    "check",
    "commission",
    "control",
    "door",
    "hand",
    "link",
    "report",
    "setup",
    "supervisor",
    "wiring",
]
