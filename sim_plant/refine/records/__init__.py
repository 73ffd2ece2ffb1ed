"""Measured records: read from CSV, Parquet or MDF4, with what is odd about them."""

__all__ = ["child", "limits", "read", "recording", "sanity", "text_table", "units"]
