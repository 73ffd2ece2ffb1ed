"""Moments of a record: their axis, its parts, and changes that are shifted along it."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.twin import Twin

EVENTS = CRITERIA.search.events


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MomentAxis:
    """Where moments of one record lie: seconds, or metres of unstretched web unwound.

    Attributes
    ----------
    moments : per judged sample (samples,).
    grid : equal steps between the first and the last of them.
    looked_at : moments at which responses are simulated; empty: the middles of equal parts.
    """

    moments: Array
    grid: Array
    looked_at: tuple[float, ...] = ()

    @property
    def step(self) -> float:
        """Distance of two points of the grid."""
        return float(self.grid[1] - self.grid[0])


def moment_axis(twin: Twin, first: int, unit: str) -> MomentAxis:
    """Return the axis of moments, s or m, of a record judged from the sample ``first`` on."""
    sample_s = twin.declaration.sample_time_s
    moments: Array = np.arange(twin.speed_m_s.size, dtype=np.float64) * sample_s
    if unit == "m":
        strain = twin.declaration.web.wound_in_tension_N / twin.declaration.web.EA_N
        moments = np.cumsum(np.abs(twin.speed_m_s)) * sample_s / (1.0 + strain)
    judged: Array = moments[first:]
    grid: Array = np.linspace(judged[0], judged[-1], judged.size)
    return MomentAxis(moments=judged, grid=grid)


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    """A part of an axis in which one response, begun at ``middle``, stands for all moments."""

    low: float
    middle: float
    high: float


def parts_of(axis: MomentAxis) -> list[Part]:
    """Return the parts of a record for which a response is simulated."""
    if axis.looked_at:
        at = sorted(axis.looked_at)
        between = [0.5 * (one + two) for one, two in pairwise(at)]
        lows, highs = (float(axis.grid[0]), *between), (*between, float(axis.grid[-1]))
        rows = zip(lows, at, highs, strict=True)
        return [Part(low=low, middle=middle, high=high) for low, middle, high in rows]
    ends = np.linspace(axis.grid[0], axis.grid[-1], EVENTS.response_moments + 1)
    return [
        Part(low=low, middle=0.5 * (high + low), high=high)
        for low, high in zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True)
    ]


def resampled(values: Array, coordinate: Array, grid: Array) -> Array:
    """Return ``values`` (channels, samples at ``coordinate``) interpolated at ``grid``."""
    return np.stack([np.interp(grid, coordinate, row) for row in values])


def shifted(change: Array, samples: int) -> Array:
    """Return a change (channels, n) begun ``samples`` later; below 0: earlier, its end kept."""
    moved = np.zeros_like(change)
    if samples >= 0:
        moved[:, samples:] = change[:, : change.shape[1] - samples]
    else:
        moved[:, :samples] = change[:, -samples:]
        moved[:, samples:] = change[:, -1:]
    return moved
