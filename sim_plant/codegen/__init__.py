"""The kernel's own source in C: for one line anywhere, and for many lines side by side."""

__all__ = ["__main__", "some_entries", "target"]
