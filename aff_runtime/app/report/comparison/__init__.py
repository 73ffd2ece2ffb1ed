"""Two windows of runs, before and after."""

__all__ = ["comparing", "lacking", "page", "turns", "window"]
