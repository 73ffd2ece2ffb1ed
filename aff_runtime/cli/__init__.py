"""The aff-runtime command."""

__all__ = ["main"]
