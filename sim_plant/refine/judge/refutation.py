"""What explains the records fitted and not the one held out is no explanation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.judge.holdout import Evaluation

JUDGE = CRITERIA.judge
STATES = ("_angle_rad", "_radius_m")
"""Ends of names of channels whose start differs from record to record: not judged here."""


def refuted(evaluation: Evaluation) -> bool:
    """Return whether the effects found leave most of what a record held out shows.

    Also where the line does not run there with them (``after`` is not finite): no web follows
    some outlines on a smaller roll.

    Equation: mean max(0, (after / floor)^2 - 1) > ``refuted_share`` mean max(0, (before /
    floor)^2 - 1), and the latter mean at least ``least_power``; over all channels but angles and
    radii, whose start differs from record to record  [own].
    """
    if not np.isfinite(evaluation.after).all():
        return True
    shown = _beyond_noise(evaluation, evaluation.before)
    return shown >= JUDGE.least_power and left(evaluation) > JUDGE.refuted_share * shown


def left(evaluation: Evaluation) -> float:
    """Return the power beyond that of noise that the effects leave, in powers of noise.

    Equation: mean of max(0, (after / floor)^2 - 1) over all channels but angles and radii  [own].
    """
    return _beyond_noise(evaluation, evaluation.after)


def leaves_much(evaluation: Evaluation) -> bool:
    """Return whether what is left on a record held out is surely more than noise."""
    return left(evaluation) >= JUDGE.least_power


def takes_little(evaluation: Evaluation, without: Evaluation) -> bool:
    """Return whether an effect takes less away than all of them leave.

    ``without`` is the record judged without it. Such an effect can be an imitation of what the
    others' models leave: nothing on this record tells the two apart.
    """
    taken = left(without) - left(evaluation)
    return taken < JUDGE.taken_share * left(evaluation)


def _beyond_noise(evaluation: Evaluation, rms: Array) -> float:
    """Return the mean of ``left`` for these rms values (channels,)."""
    judged = np.array([not name.endswith(STATES) for name in evaluation.channels])
    power = (rms[judged] / evaluation.floor[judged]) ** 2 - 1.0
    return float(np.mean(np.maximum(power, 0.0)))


def made_worse(evaluation: Evaluation) -> tuple[str, ...]:
    """Return the channels of force and speed in which the effects found raise the error.

    Equation: after^2 - before^2 > ``worse_power`` floor^2  [own]. For effects found beside
    something unknown: how much they have to explain is not known then, but an effect that is
    there raises the error in no channel.
    """
    added = (evaluation.after**2 - evaluation.before**2) / evaluation.floor**2
    return tuple(
        name
        for name, more in zip(evaluation.channels, added, strict=True)
        if more > JUDGE.worse_power and not name.endswith(STATES)
    )


def as_declared(evaluation: Evaluation) -> Evaluation:
    """Return the evaluation without effects: after is as before."""
    return replace(
        evaluation,
        after=evaluation.before,
        amended=evaluation.declared,
        effects=(),
        angles_rad={},
        unwound_m={},
        moments={},
        frequencies_Hz={},
    )
