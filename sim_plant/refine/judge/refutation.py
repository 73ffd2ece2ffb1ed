"""What explains the records fitted and not the one held out is no explanation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.judge.holdout import Evaluation

JUDGE = CRITERIA.judge
STATES = ("_angle_rad", "_radius_m")
"""Ends of channels that begin anew in each record."""


def refuted(evaluation: Evaluation) -> bool:
    """Return whether the effects found leave most of what a record held out shows.

    Equation: sum max(0, (after / floor)^2 - 1) > share sum max(0, (before / floor)^2 - 1) over all
    channels but angles, whose start differs from record to record  [own].
    """
    judged = np.array([not name.endswith("_angle_rad") for name in evaluation.channels])

    def beyond_noise(rms: Array) -> float:
        power = (rms[judged] / evaluation.floor[judged]) ** 2 - 1.0
        return float(np.mean(np.maximum(power, 0.0)))

    there = beyond_noise(evaluation.before)
    if there < JUDGE.least_power:
        return False
    return beyond_noise(evaluation.after) > JUDGE.refuted_share * there


def made_worse(evaluation: Evaluation) -> tuple[str, ...]:
    """Return the channels of force and speed to which the effects found add what is not there.

    Equation: after^2 - before^2 > share floor^2  [own]. Beside something unknown nothing tells
    how much effects have to explain; but what an effect adds is there or not.
    """
    added = (evaluation.after**2 - evaluation.before**2) / evaluation.floor**2
    return tuple(
        name
        for name, more in zip(evaluation.channels, added, strict=True)
        if more > JUDGE.worse_power and not name.endswith(STATES)
    )


def as_declared(evaluation: Evaluation) -> Evaluation:
    """Return the evaluation with no effect."""
    return replace(
        evaluation,
        after=evaluation.before,
        amended=evaluation.declared,
        effects=(),
        angles_rad={},
        unwound_m={},
        moments={},
    )
