"""What one count of a recorded word is: the site file's scale, or less where readings say so.

A register's scale is one count. On CAN by DBC the database already makes numbers of counts, and
the scale of the site file is a factor on these; so it is of a register that holds a float.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA


def one_count(values: Array, scale: float) -> float:
    """Return one count of the word that ``values`` (samples,) were read from; ``scale`` at most.

    Readings that come closer to each other than half a ``scale`` are finer than that: what lies
    between the closest two is one count then. 0 where ``scale`` is.
    """
    finite = values[np.isfinite(values)]
    steps = np.abs(np.diff(finite))
    steps = steps[steps > 0.0]
    if scale <= 0.0 or steps.size == 0:
        return scale
    finest = float(np.min(steps))
    return finest if finest < CRITERIA.records.run.finer_share * scale else scale


def counts_of(columns: Mapping[str, Array], scales: Mapping[str, float]) -> dict[str, float]:
    """Return one count of every channel, by the readings that were recorded of it."""
    return {
        name: one_count(columns[name], scale) if name in columns else scale
        for name, scale in scales.items()
    }
