"""The probe: tones out, response measured."""
