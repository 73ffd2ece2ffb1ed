"""The sim-plant command."""

__all__ = ["main"]
