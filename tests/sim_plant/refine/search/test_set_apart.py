"""A weak effect without a line beside a strong one with a line, the model 3 % wrong in that."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import gauss_newton_fit, nominal_fit
from sim_plant.refine.fit.objective import conditioned_on
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search.completeness import remaining_spectra
from sim_plant.refine.search.free_terms import free_term_basis
from sim_plant.refine.search.one_more import best_of
from sim_plant.refine.search.remainder import classified
from sim_plant.refine.search.selection import AcceptedEffect, Selection
from sim_plant.refine.search.set_apart import own_spectral_lines, set_apart
from sim_plant.refine.spectra.coordinates import orders_of
from tests.sim_plant.refine.small import STEP_S, axes_at, formula_twin, objective_of, quiet, white

ACCEPTANCE = CRITERIA.search.acceptance
SAMPLES, JUDGED = 6000, 4500
CHANNELS = ("unwind_tension_N", "rewind_tension_N")
ECCENTRIC = hypothesis(BY_NAME["eccentric_roller"], "R6")
DRAG = hypothesis(BY_NAME["bearing_drag"], "R2")
FILTER = hypothesis(BY_NAME["load_cell_filter"], "all")
AXES = axes_at(np.ones(SAMPLES))
TURNS_RAD = AXES.angles_rad[AXES.declaration.body("R6")]
STEPS = np.sign(np.sin(2.0 * np.pi * np.arange(SAMPLES) / 1700.0))
WRONG = 0.03
STRONG = 16.0
"""Size of the line, in noise; it explains N STRONG^2 = 1.2e6, of which 0.1 % is 1200."""


def response(case):
    """Return two tensions: a line, a slow square wave, and one that is at the line alone."""
    found = np.zeros((2, SAMPLES))
    for effect in case.effects:
        size = dict(effect.parameters)
        if effect.effect == "eccentric_roller":
            sizes = [size[name] / ECCENTRIC.start[0] for name in ECCENTRIC.names]
            found += sizes[0] * np.cos(TURNS_RAD) + sizes[1] * np.sin(TURNS_RAD)
        elif effect.effect == "bearing_drag":
            found += size["constant_N_m"] / DRAG.start[0] * STEPS
        else:
            line = size["lag_s"] / FILTER.start[0] * np.cos(TURNS_RAD)
            found += np.stack([line, -line])
    return found


@cache
def found_first(drag, wrong=WRONG, wave=0.0):
    """Return the objective of a record with so much drag, and the line that was found in it.

    ``wave`` is the size of one of 2.3 Hz, that no effect has.
    """
    error = np.array([1.0 + wrong, 1.0 - wrong])[:, None]
    line = STRONG * error * np.cos(TURNS_RAD)
    measured = line + drag * STEPS + white((2, SAMPLES), 3)
    measured += wave * np.sin(2.0 * np.pi * 2.3 * STEP_S * np.arange(SAMPLES))
    objective = objective_of(formula_twin(response, CHANNELS, SAMPLES), measured)
    nominal = nominal_fit(objective)
    fit = gauss_newton_fit(objective, (ECCENTRIC,), (ECCENTRIC.start,), {})
    record_axes = (axes_at(np.ones(JUDGED)),)  # angles from 0 on: a line has any phase
    first = AcceptedEffect(
        hypothesis=ECCENTRIC, score=1e6, runner_up=None, margin=1e6, rejected=()
    )
    spectra = remaining_spectra(objective, fit, record_axes)
    return objective, Selection(
        nominal=nominal,
        fit=fit,
        record_axes=record_axes,
        spectra_declared=spectra,
        spectra_left=spectra,
        accepted=(first,),
    )


def claimed(h, drag, apart=True):
    """Return what is accepted of a group of one, and the effect apart from the line."""
    objective, selection = found_first(drag)
    there = set_apart(objective, selection, at_spectral_lines=True) if apart else None
    return best_of(objective, selection, [h], quiet, apart=there)


DRAG_SIZE = 0.3
"""Explains 2 JUDGED 0.3^2 = 810: more than later_score, less than 0.1 % of the line."""


def test_what_has_no_line_is_found_beside_a_strong_line():
    assert claimed(DRAG, DRAG_SIZE, apart=False) is None
    found = claimed(DRAG, DRAG_SIZE)
    assert found.hypothesis.key == DRAG.key
    most = 2 * JUDGED * DRAG_SIZE**2  # drift may hold some of a wave as slow
    assert 0.6 * most < found.accepted.score < 1.2 * most
    assert found.fit.values[-1][0] == pytest.approx(DRAG_SIZE * DRAG.start[0], rel=0.1)


def test_what_only_mends_the_line_explains_nothing_apart_from_it():
    objective, selection = found_first(0.0)
    left = selection.fit.cost - objective.expected_cost
    assert left > 2.0 * ACCEPTANCE.later_score  # what the model has wrong
    assert claimed(FILTER, 0.0) is None
    assert claimed(DRAG, 0.0) is None


@pytest.mark.parametrize(
    ("wrong", "wave", "kinds"), [(0.12, 0.0, []), (0.0, 1.9, ["broadband"]), (0.0, 0.0, [])]
)
def test_what_a_strong_effect_leaves_at_its_own_line_takes_no_partner_back(wrong, wave, kinds):
    """Either leaves some 2 JUDGED 1.9^2 / 2 = 16 000: 1.4 % of what the line explains.

    That is more than 0.3 of what the drag, 810, explains with it. Elsewhere it may be the cause
    that the drag imitates.
    """
    objective, selection = found_first(DRAG_SIZE, wrong, wave)
    drag = best_of(
        objective,
        selection,
        [DRAG],
        quiet,
        apart=set_apart(objective, selection, at_spectral_lines=True),
    )
    accepted = (*selection.accepted, drag.accepted)
    after = remaining_spectra(objective, drag.fit, selection.record_axes)
    both = replace(selection, fit=drag.fit, accepted=accepted, spectra_left=after)
    left = objective.excess(both.fit.cost, both.fit.residual)
    assert (left > 12_000.0) is bool(wrong or wave)
    assert [u.unknown_class for u in classified(objective, both).unknown] == kinds


def test_nothing_is_set_apart_where_it_decides_nothing():
    objective, selection = found_first(0.0)
    nothing = replace(selection, nominal=selection.fit)
    assert set_apart(objective, nothing, at_spectral_lines=True) is None  # explains nothing
    slow = np.ones((JUDGED, 1)) / np.sqrt(JUDGED)
    assert set_apart(conditioned_on(objective, [slow]), selection, at_spectral_lines=True) is None


@pytest.mark.parametrize("apart", [True, False])
def test_beside_a_strong_line_first_looks_keep_declared_numbers_where_they_are(apart):
    """Back at the declared number the line itself would answer, more than what is looked for."""
    objective, selection = found_first(DRAG_SIZE)
    moved = {"web.EA_N": 0.012}
    there = replace(selection, fit=replace(selection.fit, shifts=moved))
    simulated = objective.pool.twins[0].simulated
    simulated.clear()
    objective.pool.responses.clear()
    best_of(
        objective,
        there,
        [DRAG],
        quiet,
        apart=set_apart(objective, there, at_spectral_lines=True) if apart else None,
    )
    looked = next(
        case for case in simulated if any(e.effect == "bearing_drag" for e in case.effects)
    )
    assert dict(looked.shifts) == (moved if apart else {})


@pytest.mark.parametrize(
    ("effect", "fixed"), [("torque_ripple", (("order", 18.0),)), ("nip_pulse", ())]
)
def test_a_line_that_is_no_low_order_of_its_body_is_set_apart_too(effect, fixed):
    line = AXES.declaration
    at = line.rollers[line.body("pull_roll")]
    h = hypothesis(BY_NAME[effect], "pull_roll", fixed)
    (order,) = orders_of(h, at.radius_m)
    _, selection = found_first(0.0)
    found = replace(selection.accepted[0], hypothesis=h)
    lines = own_spectral_lines(replace(selection, accepted=(found,)))
    basis = free_term_basis(lines, selection.record_axes[0])
    turns = selection.record_axes[0].angles_rad[line.body("pull_roll")]
    shown = np.cos(order * turns + 0.4)
    assert np.sum((basis.T @ shown) ** 2) > 0.99 * np.sum(shown**2)
