"""The probe: tones out, response measured."""

__all__ = ["estimate", "probe", "repeats"]
