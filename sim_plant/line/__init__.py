"""Declared lines: loader, compiled kernel, frequency model, simulation."""

from sim_plant.line.open import open_line

__all__ = [
    "alone",
    "arrays",
    "declared",
    "equations",
    "linear",
    "open",
    "open_line",
    "reading",
    "record_file",
    "rest",
    "running",
    "yaml_file",
]
