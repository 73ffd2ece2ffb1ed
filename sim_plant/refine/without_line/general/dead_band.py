"""A dead band: an input that does nothing near zero."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.without_line.general.effect import (
    GeneralEffect,
    Number,
    OutputRecord,
    PlacedEffect,
    pooled,
)

GENERAL = CRITERIA.without_line.general


def change(_record: OutputRecord, placed: PlacedEffect, values: Array) -> Array:
    """Return sign(u) max(|u| - half width, 0)."""
    half_width = abs(placed.numbers[0])
    return values - np.clip(values, -half_width, half_width)


def starts(records: Sequence[OutputRecord]) -> list[PlacedEffect]:
    """Return half widths by the share of the readings that lie within."""
    choices = []
    for name in records[0].inputs:
        values = pooled(records, name)
        if values.min() < 0.0 < values.max():
            for half in np.quantile(np.abs(values), GENERAL.dead_band_starts):
                choices.append(
                    PlacedEffect(effect=EFFECT.name, place=name, numbers=(float(half),))
                )
    return choices


EFFECT = GeneralEffect(
    name="dead_band",
    stage="raw",
    text="the input does nothing until it is larger than the band",
    numbers=(Number(name="half_width", text="half width of the band, in the input's unit"),),
    starts=starts,
    change=change,
)
