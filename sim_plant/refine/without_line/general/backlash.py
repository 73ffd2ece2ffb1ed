"""Backlash: an input that has to take up play when it turns round."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.base.jit import compiled
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
    """Return what follows ``values`` at a distance of at most half the play (samples,)."""
    followed: Array = np.empty(values.size)
    _play(np.asarray(values, dtype=np.float64), 0.5 * abs(placed.numbers[0]), followed)
    return followed


@compiled
def _play(values: Array, half: float, followed: Array) -> None:
    """Write into ``followed`` what follows ``values`` at a distance of at most ``half``."""
    at = values[0]
    for k in range(values.size):
        at = min(max(at, values[k] - half), values[k] + half)
        followed[k] = at


def starts(records: Sequence[OutputRecord]) -> list[PlacedEffect]:
    """Return plays by their share of the input's standard deviation."""
    choices = []
    for name in records[0].inputs:
        spread = float(np.std(pooled(records, name)))
        if spread > 0.0:
            choices += [
                PlacedEffect(effect=EFFECT.name, place=name, numbers=(share * spread,))
                for share in GENERAL.backlash_starts
            ]
    return choices


EFFECT = GeneralEffect(
    name="backlash",
    stage="raw",
    text="the input has to take up play whenever it turns round",
    numbers=(Number(name="play", text="whole play, in the input's unit"),),
    starts=starts,
    change=change,
)
