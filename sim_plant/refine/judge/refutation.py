"""What explains the records fitted and not the one held out is no explanation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.judge.holdout import Evaluation, rms

JUDGE = CRITERIA.judge
REMAINDER_SHARE = CRITERIA.search.unexplained.remainder_share
STATES = ("_angle_rad", "_radius_m")
"""Ends of names of channels whose start differs from record to record: not judged here."""


def refuted(evaluation: Evaluation) -> bool:
    """Return whether the effects found are not there in a record held out.

    They leave most of what it shows, and it does not show their response: where it does, the rest
    is something else, which only this record has. Or it ``lacks`` their response, however little
    there is to explain: declared numbers estimated anew with the effects may explain it all.
    Where an event's moment was fitted on this record a slope proves nothing: among so many
    moments some one gives a slope near 1 by chance. Refuted too where the line does not run there
    with them (``after`` is not finite), as some profiles cannot lie on a smaller roll: the
    simulation breaks down.
    """
    if not np.isfinite(evaluation.rms_amended).all():
        return True
    if evaluation.moments:
        return leaves_most(evaluation)
    if lacks(evaluation, evaluation.corrected):
        return True
    return leaves_most(evaluation) and not shows(evaluation, evaluation.corrected)


def shows_something_else(evaluation: Evaluation) -> bool:
    """Return whether effects that are there leave most of what a record held out shows."""
    return leaves_most(evaluation) and not refuted(evaluation)


def leaves_most(evaluation: Evaluation) -> bool:
    """Return whether the effects found leave most of what a record held out shows.

    Equation: mean max(0, (after / floor)^2 - 1) > ``refuted_share`` mean max(0, (before /
    floor)^2 - 1), and the latter mean at least ``least_power``; over all channels but angles and
    radii, whose start differs from record to record  [own].
    """
    shown = _beyond_noise(evaluation, evaluation.rms_declared)
    return shown >= JUDGE.least_power and left(evaluation) > JUDGE.refuted_share * shown


def shows(evaluation: Evaluation, without: Array) -> bool:
    """Return whether a record shows the response of some effects.

    ``without`` (channels, samples): the simulation without the effects asked about.

    Something else in the record, however strong, moves the slope only as far as it is like that
    response. Equation: |b - 1| + ``slope_sd`` s < ``slope_off``, b = sum(r y) / sum(r^2) of record
    y and response r (both less ``without``, in floors), s^2 = sum over blocks of
    sum(r (y - b r))^2 / sum(r^2)^2  [White 1980, Liang and Zeger 1986]. In one block s is 0
    whatever the record has: the number of blocks that count, (sum p)^2 / sum(p^2) with p the
    power of r per block, is ``slope_fewest_blocks`` at least  [Kish 1965].
    """
    slope, sd = _slope(evaluation, without)
    return abs(slope - 1.0) + JUDGE.slope_sd * sd < JUDGE.slope_off


def lacks(evaluation: Evaluation, without: Array) -> bool:
    """Return whether a record has not half of the response of some effects, and could tell.

    However little they explain: what took no power away from a record held out took none from
    those fitted either, but a chance of theirs. ``without``, b and s as of ``shows``; equation:
    b < 1 - ``slope_off`` and ``slope_sd`` s < ``slope_off``.
    """
    slope, sd = _slope(evaluation, without)
    return slope < 1.0 - JUDGE.slope_off and JUDGE.slope_sd * sd < JUDGE.slope_off


def _slope(evaluation: Evaluation, without: Array) -> tuple[float, float]:
    """Return the slope of a record on a response and its standard deviation, inf if not known."""
    y = in_floors(evaluation, evaluation.measured - without)
    response = in_floors(evaluation, evaluation.amended - without)
    shares = _sums(response**2)
    power = float(np.sum(shares))
    if not power**2 > JUDGE.slope_fewest_blocks * float(np.sum(shares**2)):
        return 0.0, np.inf
    slope = float(np.sum(response * y)) / power
    sd = float(np.linalg.norm(_sums(response * (y - slope * response)))) / power
    return slope, sd


def judged_channels(evaluation: Evaluation) -> npt.NDArray[np.bool_]:
    """Return which channels (channels,) are judged: all but angles and radii."""
    return np.array([not name.endswith(STATES) for name in evaluation.channels], dtype=np.bool_)


def in_floors(evaluation: Evaluation, difference: Array) -> Array:
    """Return a difference (channels, samples) where it is judged, in noise floors of each channel.

    (judged channels, judged samples).
    """
    judged = judged_channels(evaluation)
    rows: Array = difference[judged, evaluation.first :] / evaluation.floor[judged, np.newaxis]
    return rows


def _sums(values: Array) -> Array:
    """Return the sum of (channels, samples) over each block of samples (blocks,)."""
    blocks = np.array_split(values.sum(axis=0), JUDGE.slope_blocks)
    return np.array([float(block.sum()) for block in blocks])


def left(evaluation: Evaluation) -> float:
    """Return the power beyond the noise that effects leave, as a multiple of the noise's power.

    Equation: mean of max(0, (after / floor)^2 - 1) over all channels but angles and radii  [own].
    """
    return _beyond_noise(evaluation, evaluation.rms_amended)


def leaves_much(evaluation: Evaluation) -> bool:
    """Return whether what is left on a record held out is surely more than noise."""
    return left(evaluation) >= JUDGE.least_power


def leaves_large(evaluation: Evaluation) -> bool:
    """Return whether what effects leave on a record held out is too much for a cause named alone.

    A right effect leaves no more than ``remainder_share`` of what it explains. Equation, of one
    channel or of all: sum left > ``remainder_share`` sum shown, and sum left / n at least
    ``least_power``; of the power beyond noise, n all channels but angles and radii  [own].
    """
    shown, rest = (
        _each(evaluation, evaluation.rms_declared),
        _each(evaluation, evaluation.rms_amended),
    )
    parts = [(float(rest.sum()), float(shown.sum())), *zip(rest, shown, strict=True)]
    return any(
        here >= JUDGE.least_power * rest.size and here > REMAINDER_SHARE * there
        for here, there in parts
    )


def takes_less_than_left(evaluation: Evaluation, reduced: Evaluation) -> bool:
    """Return whether an effect takes less away than all effects leave: it can be an imitation.

    ``reduced`` is the record judged without it. What is left may be what the others' models have
    wrong: nothing on this record tells the two apart.
    """
    return left(reduced) - left(evaluation) < JUDGE.taken_share * left(evaluation)


def takes_little(evaluation: Evaluation, reduced: Evaluation) -> bool:
    """Return whether an effect takes so little away that it is not claimed.

    An effect of which ``takes_less_than_left`` holds is claimed all the same where the record
    shows its response and it takes more than the others' models can have wrong,
    ``remainder_share`` of what all explain. What is left is then unknown beside it, as it may be
    an imitation: where that cause acts in the held-out record too, the imitation's response
    shows there as well. Not so an effect whose moment was fitted on this record, see ``refuted``.
    """
    if not takes_less_than_left(evaluation, reduced):
        return False
    if evaluation.moments.keys() - reduced.moments.keys():
        return True
    taken, rest = left(reduced) - left(evaluation), left(evaluation)
    explained = _beyond_noise(evaluation, evaluation.rms_declared) - rest
    return taken <= REMAINDER_SHARE * explained or not shows(evaluation, reduced.amended)


def _beyond_noise(evaluation: Evaluation, rms: Array) -> float:
    """Return the mean of ``left`` for these rms values (channels,)."""
    return float(np.mean(_each(evaluation, rms)))


def _each(evaluation: Evaluation, rms: Array) -> Array:
    """Return the power beyond noise of each judged channel for these rms values (channels,)."""
    judged = judged_channels(evaluation)
    power: Array = np.maximum((rms[judged] / evaluation.floor[judged]) ** 2 - 1.0, 0.0)
    return power


def made_worse(evaluation: Evaluation) -> tuple[str, ...]:
    """Return the channels of force and speed in which the effects found raise the error.

    Equation: amended^2 - declared^2 > ``worse_power`` floor^2  [own]. For effects found beside
    something unknown: how much they have to explain is not known then, but an effect that is
    there raises the error in no channel.
    """
    added = (evaluation.rms_amended**2 - evaluation.rms_declared**2) / evaluation.floor**2
    worse = judged_channels(evaluation) & (added > JUDGE.worse_power)
    return tuple(
        name for name, is_worse in zip(evaluation.channels, worse, strict=True) if is_worse
    )


def as_declared(evaluation: Evaluation) -> Evaluation:
    """Return the evaluation without effects: amended is as declared."""
    return replace(
        evaluation,
        rms_amended=evaluation.rms_declared,
        corrected=evaluation.declared,
        amended=evaluation.declared,
        effects=(),
        angles_rad={},
        unwound_m={},
        moments={},
        frequencies_Hz={},
    )


def of_numbers_alone(evaluation: Evaluation) -> Evaluation:
    """Return the evaluation of declared numbers as estimated with the effects, without these."""
    left = evaluation.measured - evaluation.corrected
    return replace(evaluation, rms_amended=rms(evaluation.channels, left, evaluation.first))
