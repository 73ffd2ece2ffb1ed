"""numba for this package: as the campaign's generator has it, under a cache of its own."""

from __future__ import annotations

from pathlib import Path

from benchmarks.campaign.jit import compiler

compiled = compiler("aff-blind", Path(__file__).parent, ("plant.py", "run.py"))
"""Compiles a function of this package."""
