"""Angles of a run without their starts over: every step is what the roll can have turned.

A count starts over after each turn or a few, or where its register ends. Between two readings the
roll turned as fast as around them, for as long as lies between them: what a step differs from
that by whole starts over is taken off. So no turn is lost where ticks or readings are missing,
and none comes in where the count began anew.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from scipy.ndimage import median_filter

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.records.run_grid import LONGEST_HOLE_STEPS

RECORDS = CRITERIA.records


def without_starts_over(
    columns: Mapping[str, Array],
    taken_s: Array,
    step_s: float,
    registers_rad: Mapping[str, float] | None = None,
) -> tuple[dict[str, Array], list[str]]:
    """Return the columns with angles that go on and on, and remarks.

    Parameters
    ----------
    columns : (scans,) each; a reading that is missing stays so.
    taken_s : when each scan was taken. ``step_s`` : of the grid that scans belong on.
    registers_rad : by column, what its register holds before it starts over, where that is known.
    """
    continuous, remarks, known = dict(columns), [], registers_rad or {}
    for name, values in columns.items():
        read = np.flatnonzero(np.abs(values) < RECORDS.run.largest_count)
        if not name.endswith("_rad") or read.size < 3:
            continue
        over_rad = _starts_over(values[read], taken_s[read], step_s, known.get(name, 0.0))
        if np.any(over_rad):
            continuous[name] = values.copy()
            continuous[name][read[1:]] -= np.cumsum(over_rad)
            count = np.count_nonzero(over_rad)
            remarks.append(f"{name} starts over {count} times: unwrapped")
    return continuous, remarks


def _starts_over(values: Array, taken_s: Array, step_s: float, register_rad: float) -> Array:
    """Return by how much each step (readings - 1,) is off because the count started over, rad.

    A register that holds no whole turns starts over where it ends, unless most of its odd steps
    are whole turns: the PLC counts from zero in it then, each turn or each few. Over a hole that
    ends a piece no phase is kept: there the nearest whole number is taken.
    """
    elapsed_s = np.diff(taken_s)
    off = np.diff(values) - _expected(np.diff(values), elapsed_s)
    ends = elapsed_s > LONGEST_HOLE_STEPS * step_s
    found = np.zeros_like(off)
    for period_rad in ((register_rad,) if register_rad > 0.0 else ()) + (math.tau,):
        odd = np.abs(off) > 0.5 * period_rad
        over_rad = period_rad * np.rint(off / period_rad)
        within_rad = min(_scatter_rad(off[~odd]), 0.5 * period_rad)
        is_wrap = odd & (np.abs(off - over_rad) <= within_rad)
        found = np.where(is_wrap | ends, over_rad, 0.0)
        if 2 * np.count_nonzero(is_wrap & ~ends) > np.count_nonzero(odd & ~ends):
            break
    return found


def _expected(steps: Array, elapsed_s: Array) -> Array:
    """Return how far the roll turned between two readings, by its speed around them, rad.

    The speed is the median of the usual steps around; starts over are fewer than half of these
    where the roll turns by less than half a turn from reading to reading.
    """
    usual = (elapsed_s > 0.0) & (elapsed_s < RECORDS.usual_step * np.median(elapsed_s))
    if not usual.any():
        return np.zeros_like(steps)
    at_s = np.cumsum(elapsed_s) - 0.5 * elapsed_s
    rate = median_filter(steps[usual] / elapsed_s[usual], RECORDS.turning_steps, mode="nearest")
    return np.asarray(np.interp(at_s, at_s[usual], rate) * elapsed_s)


def _scatter_rad(off: Array) -> float:
    """Return how far a step may be off the expected one, by those without a start over."""
    usual = float(np.quantile(np.abs(off), RECORDS.scatter_share)) if off.size else 0.0
    return RECORDS.counter_wrap_rad + RECORDS.counter_wrap_scatter * usual
