"""An effect whose size wanders, and another beside it that acts in other shares."""

import dataclasses

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME, CATALOGUE
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import gauss_newton_fit, nominal_fit
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search.completeness import remaining_spectra
from sim_plant.refine.search.one_more import best_of
from sim_plant.refine.search.remainder import classified
from sim_plant.refine.search.selection import AcceptedEffect, Selection
from sim_plant.refine.search.set_apart import set_apart
from sim_plant.refine.search.unexplained import what_is_left
from sim_plant.refine.search.wandering import (
    raised_for_a_while,
    wander_changes,
    weighed_with_wander,
)
from tests.sim_plant.refine.small import (
    STEP_S,
    axes_at,
    fit_of,
    formula_twin,
    objective_of,
    quiet,
    white,
)

SAMPLES, JUDGED = 6000, 4500
CHANNELS = ("unwind_tension_N", "rewind_tension_N")
SLIP = hypothesis(BY_NAME["slip"], "swrap", (("threshold_m_s", 0.5),), ("slope_s_m",))
DRAG = hypothesis(BY_NAME["bearing_drag"], "R2")
TIME_S = STEP_S * np.arange(SAMPLES)
STEPS = np.sign(np.sin(2.0 * np.pi * TIME_S / 17.0))
SLIP_SHARES, DRAG_SHARES = np.array([[1.0], [-0.5]]), np.array([[1.0], [1.0]])
STRONG = 30.0
"""Size of the slip, in noise; 2 % of what it explains, JUDGED 1.25 STRONG^2, is 1e5."""


def response(case):
    """Return two tensions without delay: slip while it is there, drag as a square wave."""
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


def found_first(drag, wander):
    """Return the objective of a record in which slip wanders so much, and slip as it is found."""
    size = 1.0 + wander * np.sin(2.0 * np.pi * TIME_S / 17.0 + 0.4)
    measured = STRONG * SLIP_SHARES * size + drag * DRAG_SHARES * STEPS + white((2, SAMPLES), 3)
    objective = objective_of(formula_twin(response, CHANNELS, SAMPLES), measured)
    nominal = nominal_fit(objective)
    fit = gauss_newton_fit(objective, (SLIP,), (SLIP.start,), {})
    record_axes = (axes_at(np.ones(JUDGED)),)
    score = nominal.cost - fit.cost
    first = AcceptedEffect(hypothesis=SLIP, score=score, runner_up=None, margin=score, rejected=())
    spectra = remaining_spectra(objective, fit, record_axes)
    return objective, Selection(
        nominal=nominal,
        fit=fit,
        record_axes=record_axes,
        spectra_declared=spectra,
        spectra_left=spectra,
        accepted=(first,),
    )


def claimed(drag, wander, apart):
    objective, selection = found_first(drag, wander)
    there = set_apart(objective, selection, at_spectral_lines=False) if apart else None
    return best_of(objective, selection, [DRAG], quiet, apart=there)


def test_beside_what_wanders_another_effect_is_found_by_what_the_wander_is_not():
    """Across (1, -0.5) stand 1.8 of the 2 of (1, 1) squared; drift may hold some of a wave."""
    assert claimed(1.0, 0.05, apart=False) is None
    found = claimed(1.0, 0.05, apart=True)
    assert found.hypothesis.key == DRAG.key
    steady = claimed(1.0, 0.0, apart=True).accepted.score
    assert found.accepted.score == pytest.approx(steady, rel=0.1)
    assert 0.5 * 1.8 * JUDGED < steady < 1.8 * JUDGED


def test_the_wander_itself_is_no_other_effect():
    """Stairs of 2 s leave (2 pi 2 / 17)^2 / 12 = 4.6 % of it; drift takes up slow parts before."""
    objective, selection = found_first(0.0, 0.05)
    left = selection.fit.cost - objective.expected_cost
    assert left > 5.0 * CRITERIA.search.acceptance.later_score
    assert claimed(0.0, 0.05, apart=True) is None
    there = set_apart(objective, selection, at_spectral_lines=False)
    rest = there.selection.fit.cost - there.objective.expected_cost
    assert rest < 2.0 * 0.046 * left


def test_terms_of_a_wander_are_the_answer_interval_by_interval_and_leave_its_mean():
    objective, selection = found_first(0.0, 0.0)
    terms = wander_changes(objective.pool, selection.fit, 0)
    interval = round(CRITERIA.search.wandering.interval_s / STEP_S)
    assert len(terms) == SAMPLES // interval - 1
    share = CRITERIA.search.wandering.share * selection.fit.values[0][0] / SLIP.start[0]
    expected = np.zeros(SAMPLES)
    expected[3 * interval : 4 * interval], expected[4 * interval : 5 * interval] = -share, share
    np.testing.assert_allclose(terms[3][0], STRONG * SLIP_SHARES * expected, atol=1e-9)


def test_what_began_at_a_moment_wanders_from_there_on():
    effect = BY_NAME["slip"]
    h = hypothesis(effect, "swrap", (("threshold_m_s", 0.0),), ("slope_s_m", "from_s"))
    raised = raised_for_a_while(fit_of(h, values=((0.002, 20.0),)), 0, 1, 60.0)
    rows = [dict(one.parameters) for one in raised]
    assert {one.record_index for one in raised} == {1}
    assert rows[0]["from_s"] == 20.0
    assert rows[-1]["from_s"] + rows[-1]["hold_s"] == pytest.approx(60.0)
    assert {row["threshold_m_s"] for row in rows} == {0.0}
    assert rows[0]["slope_s_m"] == pytest.approx(0.002 * CRITERIA.search.wandering.share)


def test_every_effect_that_wanders_can_be_there_for_a_while():
    wandering = [effect for effect in CATALOGUE if effect.wander]
    assert wandering
    for effect in wandering:
        assert effect.onset is not None
        assert effect.onset.unit == "s"
        assert "hold_s" in effect.accepts


def test_what_is_too_weak_to_wander_visibly_is_not_set_apart():
    objective, selection = found_first(0.0, 0.0)
    weak = dataclasses.replace(selection.accepted[0], score=1000.0)  # 2 % of it is 20
    there = dataclasses.replace(selection, accepted=(weak,))
    assert set_apart(objective, there, at_spectral_lines=False) is None


def test_what_a_wander_leaves_is_nothing_unknown_and_what_stands_beside_it_is():
    """Half of the slip comes and goes; a drag of 8 is 1.8 64 JUDGED, 9 % of what there was."""
    objective, selection = found_first(0.0, 0.5)
    fit, record_axes = selection.fit, selection.record_axes
    assert what_is_left(objective, selection.nominal, fit, record_axes, selection.spectra_left)
    assert not classified(objective, selection).unknown
    assert classified(*found_first(8.0, 0.5)).unknown


def test_a_size_that_wanders_is_known_as_well_as_the_mean_of_its_intervals():
    """Of n intervals, each off by sqrt(w), the mean is off by sqrt(w / n)."""
    objective, selection = found_first(0.0, 0.0)
    weighed = weighed_with_wander(objective, selection.fit)
    assert weighed.expected_cost == objective.expected_cost
    fit = gauss_newton_fit(weighed, (SLIP,), selection.fit.values, {})
    intervals = JUDGED * STEP_S / CRITERIA.search.wandering.interval_s
    expected = fit.values[0][0] * np.sqrt(BY_NAME["slip"].wander / intervals)
    assert np.sqrt(fit.covariance[0, 0]) == pytest.approx(expected, rel=0.1)
    assert np.sqrt(selection.fit.covariance[0, 0]) < 0.1 * expected


def test_what_does_not_wander_is_known_as_it_was():
    objective, selection = found_first(0.0, 0.0)
    fit = dataclasses.replace(selection.fit, hypotheses=(DRAG,), values=(DRAG.start,))
    assert weighed_with_wander(objective, fit) is objective
