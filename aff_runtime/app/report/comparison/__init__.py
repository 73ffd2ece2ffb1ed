"""Two windows of runs, before and after."""

__all__ = ["comparing", "page", "turns", "window"]
