"""Friction that grows with a speed: viscous, and by the square."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.without_line.general.effect import (
    GeneralEffect,
    Number,
    OutputRecord,
    PlacedEffect,
)


def regressors(record: OutputRecord, placed: PlacedEffect) -> Array:
    """Return s |s| of a state s, and s itself where the filter lacks it (samples, 1 or 2)."""
    state = record.states()[placed.place]
    square = state * np.abs(state)
    return np.stack([square, state] if record.derivative_of_inputs else [square], axis=1)


def starts(records: Sequence[OutputRecord]) -> list[PlacedEffect]:
    """Return every input and, where the filter takes no rates, every rate."""
    return [PlacedEffect(effect=EFFECT.name, place=name) for name in records[0].states()]


EFFECT = GeneralEffect(
    name="friction_by_speed",
    stage="term",
    text="a force or torque that grows with a speed and with its square",
    sizes=(
        Number(name="per_unit2", text="output per unit of the state squared, with its sign"),
        Number(name="per_unit", text="output per unit of the state"),
    ),
    starts=starts,
    regressors=regressors,
)
