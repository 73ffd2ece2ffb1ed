"""The check of a site file: a process of its own."""

__all__ = ["limits", "record_size", "result", "validate"]
