"""Measured records: read from CSV, Parquet or MDF4, with what is odd about them."""

__all__ = [
    "child",
    "in_child",
    "limits",
    "read",
    "recording",
    "run_activity",
    "run_pieces",
    "run_site",
    "run_windows",
    "sanity",
    "text_table",
]
