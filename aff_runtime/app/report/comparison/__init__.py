"""Two windows of runs, before and after."""

__all__ = ["comparing", "lacking", "page", "steady_parts", "turns", "window"]
