"""Wiring: the one place where rooms meet."""

__all__ = ["check", "control", "door", "link", "report", "supervisor", "wiring"]
