"""From the words of a PLC to a site file: what `aff-runtime setup` and the screen ask and find."""

__all__ = ["asking", "bus", "flow"]
