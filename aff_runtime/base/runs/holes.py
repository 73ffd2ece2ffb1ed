"""Readings that lack in a record: a few are bridged between their neighbours, more are a hole."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

LONGEST_GAP_CYCLES = 4.5
"""Between two readings; a longer one is a hole."""
BRIDGED_SHARE = 0.02
"""Share of a channel's readings that lack and are bridged, above which that is said: where they
lack at the peaks alone, an order of 8 samples a turn is 2 % too small."""


def cycle_s_of(time_s: Array) -> float:
    """Return the usual time from one row to the next, s; 0 where none goes on."""
    gaps_s = np.diff(time_s)
    forward = gaps_s[gaps_s > 0.0]
    return float(np.median(forward)) if forward.size else 0.0


def holes_between(time_s: Array, cycle_s: float) -> Flags:
    """Return per step from one reading to the next (readings - 1,) whether it is a hole."""
    gaps_s = np.diff(time_s)
    return ~((gaps_s > 0.0) & (gaps_s < LONGEST_GAP_CYCLES * cycle_s))


def bridged_share(time_s: Array, values: Array) -> float:
    """Return the share of rows (rows,) that are no number and lie between two in no hole."""
    read = np.flatnonzero(np.isfinite(values))
    if read.size < 2:
        return 0.0
    lacking = np.diff(read) - 1
    is_hole = holes_between(time_s[read], cycle_s_of(time_s))
    return float(np.sum(lacking[~is_hole])) / values.size
