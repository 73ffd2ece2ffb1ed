"""What each step of the card measures: pure functions from evidence to a finding."""

__all__ = ["limits", "load_cell", "machine", "plug", "proof", "response", "shadow", "words"]
