"""The shape law's arithmetic in C, and the choice between it and numpy."""

__all__ = ["binary"]
