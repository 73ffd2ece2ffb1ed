"""Refine on measured records without a line declaration."""
