"""Criteria of a load cell whose reading depends on which way the tension went last."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim_plant.refine.criteria.criterion import criterion


@dataclass(frozen=True, slots=True, kw_only=True)
class StickingCriteria:
    """When a reading follows the tension with a gap."""

    band_Hz: tuple[float, float] = criterion(
        (0.15, 4.0),
        "Hz",
        "in which readings and speeds are compared",
        "below, radii and draws are off by their tolerances; above, idlers have their inertia and "
        "cells their filter",
    )
    fewest_s: float = criterion(
        20.0,
        "s",
        "of a record that are compared at least",
        "three periods of the lowest frequency",
    )
    halves_N: tuple[float, ...] = criterion(
        tuple(float(x) for x in np.geomspace(0.05, 5.0, 33)),
        "N",
        "halves of a gap that are tried",
        "from a word's step to a twentieth of a usual tension, 15 % apart",
    )
    left_share: float = criterion(
        0.6,
        "of the power that scale and lag leave",
        "a gap leaves less",
        "the readings' noise is in both; of lines without a gap 0.97 is left",
    )
    off_share: float = criterion(
        0.3, "1", "by which the gap's size may miss that of a gap, 1", "the grid's step, and noise"
    )
