"""What a perfect model would leave: innovations and slow drift."""

__all__ = ["innovations"]
