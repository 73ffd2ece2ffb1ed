"""Several lines of one make, side by side in the lanes of the processor's vectors."""

__all__ = ["library", "packing", "side_by_side"]
