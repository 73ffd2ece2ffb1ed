"""Wiring: the one place where rooms meet."""

__all__ = ["check", "control", "link", "report", "supervisor", "wiring"]
