"""The plain law: harmonic blocks in parallel."""

__all__ = ["bank", "block"]
