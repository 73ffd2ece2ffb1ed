"""How far the filter reaches back and ahead: centred on the sample, causal, or a gain alone."""

from __future__ import annotations

from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.without_line.general.effect import GeneralEffect

GENERAL = CRITERIA.without_line.general


def reaches(taps: int) -> list[tuple[str, int, int]]:
    """Return name, samples ahead and samples back of every filter to be tried.

    Parameters
    ----------
    taps : declared, on either side; no filter reaches further: all are judged on the same samples.
    """
    halves = sorted({min(half, taps) for half in (*GENERAL.halves, GENERAL.plain_half, taps)})
    filters = [(f"{2 * half + 1} taps, centred", half, half) for half in halves]
    filters += [(f"{back + 1} taps, causal", 0, back) for back in halves if back > 2]
    return filters


EFFECT = GeneralEffect(
    name="filter_length",
    stage="filter",
    text="the filter reaches further, or less far, than declared",
)
