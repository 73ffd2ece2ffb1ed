"""From a line file to its declaration; what cannot be a line is refused with its place."""

__all__ = ["load"]
