"""The state that a line began a record with, as far as the record shows it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.model.start_state import start_offsets
from sim_plant.refine.model.twin import Case, Twin
from sim_plant.refine.noise.innovations import NoiseModel, first_judged

Changes = tuple[Array, ...]
"""What one number changes, (channels, samples) per record."""


def changes_by_starts(pool: SimulationPool, point: Case, run: Changes) -> tuple[Changes, ...]:
    """Simulate what every start offset, as large as may be, changes from ``run`` at ``point``.

    Per offset and record (channels, samples): 0 in a record before which the line rested; no
    offsets at all where it rested before every record.
    """
    if all(twin.rested for twin in pool.twins):
        return ()
    offsets = start_offsets(pool.twins[0].declaration)
    runs = pool.run([replace(point, start=(offset,)) for offset in offsets], keep=False)
    largest = CRITERIA.fit.start_tension_share / CRITERIA.model.start_offset_share
    return tuple(
        tuple(
            np.zeros_like(base)
            if twin.rested
            else without_zeros(twin, np.nan_to_num(largest * (begun - base)))
            for twin, begun, base in zip(pool.twins, changed, run, strict=True)
        )
        for changed in runs
    )


def without_zeros(twin: Twin, values: Array) -> Array:
    """Return (channels, samples) with the mean of judged angles taken off: their zero is free."""
    first = first_judged(values.shape[1], twin.declaration.sample_time_s)
    angles = [c for c, name in enumerate(twin.channels) if name.endswith("_angle_rad")]
    found = values.copy()
    found[angles] -= found[angles, first:].mean(axis=1, keepdims=True)
    return found


def shown_directions(columns: Array) -> Array:
    """Return orthonormal columns (rows, k) of what innovations (rows, q) show above noise.

    Each of ``columns`` is what one number changes when it is as large as may be. A mix of them
    that then changes less than one innovation's standard deviation is not told from noise.
    Equation: left singular vectors of singular values above 1.
    """
    power, mix = _shown(columns)
    directions: Array = (columns @ mix) / np.sqrt(power)
    return directions


def _shown(columns: Array) -> tuple[Array, Array]:
    """Return power (k,) and mixes (q, k) of ``columns`` (rows, q) that are told from noise."""
    power, mix = np.linalg.eigh(columns.T @ columns)
    shown = power > 1.0
    return power[shown], mix[:, shown]


def with_start_state(
    twin: Twin, run: Array, measured: Array, changes: tuple[Changes, ...], model: NoiseModel
) -> Array:
    """Return a run of one record (channels, samples) as it is with the start that fits best.

    ``changes`` are those of ``changes_by_starts`` for a pool of that twin alone.
    """
    if not changes:
        return run
    whole = np.stack([change[0] for change in changes])
    white = np.stack([model.whiten(change).ravel() for change in whole], axis=1)
    power, mix = _shown(white)
    left = model.whiten(without_zeros(twin, measured - run)).ravel()
    sizes = mix @ ((mix.T @ (white.T @ left)) / power)
    begun: Array = run + np.tensordot(sizes, whole, axes=1)
    return begun
