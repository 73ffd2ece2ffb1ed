"""Labelled pairs that other code made, refined and scored: ``python -m benchmarks.cases``."""
