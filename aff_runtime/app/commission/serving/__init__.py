"""The commissioner itself: one person at a time, one job at a time, all of it in the audit."""

__all__ = ["commissioner"]
