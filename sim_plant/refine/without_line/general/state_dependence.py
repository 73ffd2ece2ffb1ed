"""A gain that depends on a slow state: the speed, or an input."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import uniform_filter1d

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.without_line.general.effect import (
    GeneralEffect,
    Number,
    OutputRecord,
    PlacedEffect,
)

GENERAL = CRITERIA.without_line.general
SPEED = "travel speed"
BY = " by "
"""Between input and state in the name of a place."""


def state_of(record: OutputRecord, name: str) -> Array:
    """Return the speed or an input as a running mean, the slow state (samples,)."""
    speed = record.speed_m_s if name == SPEED else record.inputs[name]
    values: Array = uniform_filter1d(
        np.asarray(speed), max(1, round(GENERAL.slow_state_s / record.step_s)), mode="nearest"
    )
    return values


def change(record: OutputRecord, placed: PlacedEffect, values: Array) -> Array:
    """Return (1 + a (s - middle)) x, the state s kept within its range in the records fitted."""
    middle, low, high = placed.constants
    state = np.clip(state_of(record, placed.place.split(BY)[1]), low, high)
    return values * (1.0 + placed.numbers[0] * (state - middle))


def starts(records: Sequence[OutputRecord]) -> list[PlacedEffect]:
    """Return every input with the speed, or with every input where there is none."""
    states = [SPEED] if records[0].speed_m_s is not None else list(records[0].inputs)
    choices = []
    for state in states:
        values = np.concatenate([state_of(v, state) for v in records])
        spread = float(np.std(values))
        if spread == 0.0:
            continue
        constants = (float(np.mean(values)), float(values.min()), float(values.max()))
        for name in records[0].inputs:
            choices += [
                PlacedEffect(
                    effect=EFFECT.name,
                    place=f"{name}{BY}{state}",
                    numbers=(share / spread,),
                    constants=constants,
                )
                for share in GENERAL.gain_starts
            ]
    return choices


EFFECT = GeneralEffect(
    name="state_dependence",
    stage="driven",
    text="the gain of an input changes with a slow state",
    numbers=(
        Number(
            name="gain_share_per_unit", text="relative change of the gain per unit of the state"
        ),
    ),
    starts=starts,
    change=change,
)
