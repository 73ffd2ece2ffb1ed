"""The control process: the tick and everything around it."""

__all__ = ["process"]
