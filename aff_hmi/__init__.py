"""The screen beside the line: a process of its own that looks on through the service's door."""

__all__ = ["main"]
