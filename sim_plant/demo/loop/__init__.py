"""The loop closed at the machine: a hidden cause recorded, traced, corrected and proved."""

__all__ = ["page", "proof", "session"]
