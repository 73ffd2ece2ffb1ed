"""Saturation: an input that does no more beyond a limit."""

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
    """Return the input within the limit, on both sides of zero."""
    limit = abs(placed.numbers[0])
    return np.clip(values, -limit, limit)


def starts(records: Sequence[OutputRecord]) -> list[PlacedEffect]:
    """Return limits by the share of the readings that they let pass."""
    choices = []
    for name in records[0].inputs:
        for limit in np.quantile(np.abs(pooled(records, name)), GENERAL.saturation_starts):
            if limit > 0.0:
                choices.append(
                    PlacedEffect(effect=EFFECT.name, place=name, numbers=(float(limit),))
                )
    return choices


EFFECT = GeneralEffect(
    name="saturation",
    stage="raw",
    text="the input does no more beyond a limit",
    numbers=(Number(name="limit", text="in the input's unit"),),
    starts=starts,
    change=change,
)
