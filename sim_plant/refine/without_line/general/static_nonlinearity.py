"""An input that acts by a curve instead of a straight line."""

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
    """Return u + a u^2 + b u^3."""
    square, cube = placed.numbers
    return values * (1.0 + values * (square + values * cube))


def starts(records: Sequence[OutputRecord]) -> list[PlacedEffect]:
    """Return, per input and share, a curve with the square alone and one with the cube alone."""
    choices = []
    for name in records[0].inputs:
        size = float(np.sqrt(np.mean(pooled(records, name) ** 2)))
        if size > 0.0:
            for share in GENERAL.curve_starts:
                for numbers in ((share / size, 0.0), (0.0, share / size**2)):
                    choices.append(PlacedEffect(effect=EFFECT.name, place=name, numbers=numbers))
    return choices


EFFECT = GeneralEffect(
    name="static_nonlinearity",
    stage="raw",
    text="the input acts by a curve, u + a u^2 + b u^3",
    numbers=(
        Number(name="square_per_unit", text="a, per unit of the input"),
        Number(name="cube_per_unit2", text="b, per unit of the input squared"),
    ),
    starts=starts,
    change=change,
)
