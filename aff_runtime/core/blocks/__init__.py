"""The plain law: harmonic blocks in parallel."""
