"""How far the filters that are tried reach back and ahead: centred on the sample, or causal.

A constant and a gain alone are tried beside them (`search`).
"""

from __future__ import annotations

from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.without_line.general.effect import GeneralEffect

GENERAL = CRITERIA.without_line.general


def reaches(furthest_samples: int) -> list[tuple[str, int, int]]:
    """Return name, samples ahead and samples back of every filter to be tried.

    Parameters
    ----------
    furthest_samples : to either side, declared as ``taps``; no filter reaches further: all are
        judged on the same samples.
    """
    tried = (*GENERAL.halves, GENERAL.plain_half, furthest_samples)
    sides = sorted({min(side, furthest_samples) for side in tried})
    filters = [(f"{2 * side + 1} taps, centred", side, side) for side in sides]
    filters += [
        (f"{side + 1} taps, causal", 0, side)
        for side in sides
        if side >= GENERAL.shortest_causal_back
    ]
    return filters


EFFECT = GeneralEffect(
    name="filter_length",
    stage="filter",
    text="the filter reaches further, or less far, than declared",
)
