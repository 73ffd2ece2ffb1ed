"""The probe: tones out, response measured."""

__all__ = ["probe", "repeats"]
