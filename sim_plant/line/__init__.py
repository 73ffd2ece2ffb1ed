"""Declared lines: loader, compiled kernel, frequency model, simulation."""

from sim_plant.line.open import open_line

__all__ = ["open_line"]
