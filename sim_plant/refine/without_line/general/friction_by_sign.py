"""Dry friction: a step of the output where a state changes its sign."""

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
)

GENERAL = CRITERIA.without_line.general


def regressors(record: OutputRecord, placed: PlacedEffect) -> Array:
    """Return s / sqrt(s^2 + soft^2), the sign of a state s that fades near zero (samples, 1)."""
    state = record.states()[placed.place]
    sign: Array = (state / np.hypot(state, placed.constants[0]))[:, None]
    return sign


def starts(records: Sequence[OutputRecord]) -> list[PlacedEffect]:
    """Return every state that has both signs."""
    choices = []
    for name in records[0].states():
        state = np.concatenate([v.states()[name] for v in records])
        positive = float(np.mean(state > 0.0))
        least = GENERAL.least_side_share
        if least < positive < 1.0 - least and np.mean(state < 0.0) > least:
            soft = GENERAL.soft_sign_share * float(np.sqrt(np.mean(state**2)))
            choices.append(PlacedEffect(effect=EFFECT.name, place=name, constants=(soft,)))
    return choices


EFFECT = GeneralEffect(
    name="friction_by_sign",
    stage="term",
    text="a constant force or torque against the sign of a state",
    sizes=(Number(name="step", text="output that goes with a positive sign"),),
    starts=starts,
    regressors=regressors,
)
