"""The line as it ripples by itself: what every law is compared with, run once."""

from __future__ import annotations

from functools import cache

import numpy as np

from tests.lockstep.bench import Bench, Setup

NAMES = (
    "true_unwind_tension_N",
    "true_pullroll_tension_N",
    "true_unwind_angle_rad",
    "true_swrap_follower_angle_rad",
)
SKIPPED_S, SILENT_S = 1.0, 15.0
Rows = list[tuple[float, ...]]


def watched(bench: Bench) -> Rows:
    """Return a list that gets ``NAMES`` of every sample from now on."""
    rows: Rows = []
    bench.plant.observers.append(lambda p: rows.append(tuple(p.measured[n] for n in NAMES)))
    return rows


@cache
def silent_rows() -> Rows:
    """Return ``NAMES`` for ``SILENT_S`` of the shipped line without a runtime.

    A runtime that is not armed changes no bit of it, see test_convergence.
    """
    bench = Bench(Setup())
    rows = watched(bench)
    bench.run_plant_alone(SKIPPED_S)
    rows.clear()
    bench.run_plant_alone(SILENT_S)
    return rows


def silent(name: str) -> np.ndarray:
    """Return one of ``NAMES`` of the silent line."""
    return np.array(silent_rows())[:, NAMES.index(name)]
