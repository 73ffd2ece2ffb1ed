"""The drive's own numbers, from a probe's record."""

__all__ = ["drive_fit", "phasors", "regression"]
