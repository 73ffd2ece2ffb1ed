"""One physical effect per file; absent means exactly zero."""

__all__ = ["catalogue", "eccentric_roller", "onset", "shape_rows"]
