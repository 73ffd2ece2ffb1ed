"""One physical effect per file; absent means exactly zero."""

__all__ = ["catalogue", "eccentric_roller", "onset", "phasor", "shape_rows"]
