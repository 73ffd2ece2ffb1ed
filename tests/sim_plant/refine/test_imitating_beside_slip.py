"""A weak effect beside a slip whose size wanders otherwise in the record held out."""

from pathlib import Path

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.confirm import RecordWithTwin, judge, wander_there, without_imitations
from sim_plant.refine.judge.apart import apart_from
from sim_plant.refine.judge.refutation import leaves_large, left
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.records.recording import Recording
from sim_plant.refine.search.selection import AcceptedEffect, Selection
from sim_plant.refine.search.taken_back import without_accepted
from tests.sim_plant.refine.small import LINE, STEP_S, fit_of, formula_twin, one_peak, quiet, white

SAMPLES = 6000
CHANNELS = ("unwind_tension_N", "rewind_tension_N")
TIME_S = STEP_S * np.arange(SAMPLES)
SLIP = hypothesis(BY_NAME["slip"], "swrap", (("threshold_m_s", 0.5),), ("slope_s_m",), line=LINE)
DRAG = hypothesis(BY_NAME["bearing_drag"], "R2", fitted=("constant_N_m",), line=LINE)
SLIP_SHARES, DRAG_SHARES = np.array([[1.0], [-0.5]]), np.array([[1.0], [1.0]])
STRONG = 30.0
"""Size of the slip, in noise: it explains 1.25 STRONG^2 / 2 = 562 of its power."""
STEPS = np.sign(np.sin(2.0 * np.pi * TIME_S / 5.3))
SLOW = np.sin(2.0 * np.pi * TIME_S / 17.0 + 0.4)


def response(case):
    """Return two tensions: slip while it is there, drag as a square wave."""
    found = np.zeros((2, SAMPLES))
    for effect in case.effects:
        size = dict(effect.parameters)
        if effect.effect == "slip":
            from_s, hold_s = size.get("from_s", -1.0), size.get("hold_s", 1e6)
            there = (from_s <= TIME_S) & (from_s + hold_s > TIME_S)
            found += STRONG * size["slope_s_m"] / SLIP.start[0] * SLIP_SHARES * there
        else:
            found += size["constant_N_m"] / DRAG.start[0] * DRAG_SHARES * STEPS
    return found


def held_out(rest):
    """Return a record of slip, drag, noise and this rest, and both effects as they were found."""
    both = STRONG * SLIP_SHARES + DRAG_SHARES * STEPS
    measured = both + rest + white((2, SAMPLES), 3)
    columns = dict(zip(CHANNELS, measured, strict=True))
    record = Recording(path=Path("B"), sha256="", sample_time_s=STEP_S, columns=columns)
    accepted = tuple(
        AcceptedEffect(hypothesis=h, score=score, runner_up=None, margin=score, rejected=())
        for h, score in ((SLIP, 2e5), (DRAG, 3000.0))
    )
    selection = Selection(
        nominal=fit_of(cost=3e5),
        fit=fit_of(SLIP, DRAG, values=(SLIP.start, DRAG.start)),
        record_axes=(),
        spectra_declared=one_peak(),
        spectra_left=one_peak(),
        accepted=accepted,
        ranges=({}, {}),
    )
    return RecordWithTwin(record=record, twin=formula_twin(response, CHANNELS, SAMPLES)), selection


@pytest.mark.parametrize(
    ("rest", "claimed"),
    [
        (0.1 * STRONG * SLIP_SHARES * SLOW, ["swrap", "R2"]),  # as the line answers to slip
        (3.0 * np.array([[1.0], [0.5]]) * SLOW, ["swrap"]),  # in shares that slip has not
    ],
    ids=["wander", "something else"],
)
def test_beside_a_slip_that_wanders_a_weak_effect_is_judged_apart_from_the_wander(rest, claimed):
    """Either rest has 1.25 3^2 / 4 = 2.8 of the power of noise, the drag 1: less than is left."""
    judged, selection = held_out(rest)
    evaluation = judge(judged, selection, 1, quiet, held_out=True)
    assert left(evaluation) == pytest.approx(1.25 * 9.0 / 4.0, rel=0.15)
    found = without_imitations(judged, selection, evaluation, 1, quiet)
    assert [a.hypothesis.location for a in found.selection.accepted] == claimed
    assert bool(found.selection.unknown) is (len(claimed) == 1)


def test_a_wander_is_taken_out_as_far_as_steps_of_2_s_follow_it():
    """They leave (2 pi 2 / 17)^2 / 12 = 4.6 % of it."""
    judged, selection = held_out(0.1 * STRONG * SLIP_SHARES * SLOW)
    evaluation = judge(judged, selection, 1, quiet, held_out=True)
    changes = wander_there(judged, selection, evaluation, 1, quiet)
    assert left(apart_from(evaluation, changes)) < 2.0 * 0.046 * left(evaluation)
    assert apart_from(evaluation, []) is evaluation


@pytest.mark.parametrize(
    ("rest", "classes"),
    [
        (0.35 * STRONG * SLIP_SHARES * SLOW, []),  # 6 % of what slip explains, 0.3 % apart
        (13.0 * np.array([[1.0], [0.5]]) * SLOW, ["broadband"]),  # 9 %; 64 % of it apart
    ],
    ids=["wander", "something else"],
)
def test_a_slip_alone_is_judged_apart_from_its_wander_before_more_is_unknown(rest, classes):
    """Slip's shares are (1, -0.5): cos^2 to (1, 0.5) is (0.75 / 1.25)^2 = 0.36."""
    judged, selection = held_out(rest - DRAG_SHARES * STEPS)
    lone = without_accepted(selection, 1)
    evaluation = judge(judged, lone, 1, quiet, held_out=True)
    assert leaves_large(evaluation)
    found = without_imitations(judged, lone, evaluation, 1, quiet)
    assert [a.hypothesis.location for a in found.selection.accepted] == ["swrap"]
    assert [u.unknown_class for u in found.selection.unknown] == classes
