"""Records without a line declaration: a filter, then free lines."""

__all__ = ["pipeline", "record_filter", "verdict", "wording"]
