"""Records without a line declaration: a filter, then free lines."""
