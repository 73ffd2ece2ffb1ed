"""The compiled line: its state, every balance once, one control frame at a time."""

__all__ = ["kernel", "layout", "log_layout", "rolls", "scratch"]
