"""Every number that decides something in refine: unit, meaning, and what it was set on."""

__all__ = ["criteria"]
