from dataclasses import replace

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.fit.gauss_newton import gauss_newton_fit, nominal_fit
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.model.twin import Case
from sim_plant.refine.search.exchange import exchanged, joined, scored_at, with_rivals_at_own_line
from sim_plant.refine.search.selection import AcceptedEffect, Selection
from tests.sim_plant.refine.search import rollers
from tests.sim_plant.refine.small import (
    STEP_S,
    axes_at,
    formula_twin,
    line_with,
    objective_of,
    quiet,
    white,
)

SAMPLES = 3000
SPEED = 1.0 + 0.4 * np.sin(0.5 * STEP_S * np.arange(SAMPLES))
LINE = line_with()
LEAD, FOLLOWER = "swrap_lead", "swrap_follower"


def draw(case):
    """Slip on either roller lengthens the web behind the pair alike; the lead's is seen before."""
    behind, between = np.zeros(SAMPLES), np.zeros(SAMPLES)
    for added in case.effects:
        given = dict(added.parameters)
        rollers = (LEAD, FOLLOWER) if added.location == "swrap" else (added.location,)
        for roller in rollers:
            lost = 1e4 * given["slope_s_m"] * np.maximum(0.0, SPEED - given["threshold_m_s"])
            behind, between = behind + lost, between + (lost if roller == LEAD else -lost)
    return np.stack([behind, between])


def found_without_spectra(nominal, fit, accepted):
    """Return what is found, with nothing known of the spectra of what it leaves."""
    return Selection(
        nominal=nominal,
        fit=fit,
        accepted=accepted,
        record_axes=(),
        spectra_declared=(),
        spectra_left=(),
    )


def found_beside(lead, follower):
    """Return the objective of slip (slope, threshold) on each roller, and it found on each."""
    kinds = [hypothesis(BY_NAME["slip"], at, line=LINE) for at in (LEAD, FOLLOWER)]
    twin = formula_twin(draw, ("pullroll_tension_N", "unwind_tension_N"), SAMPLES)
    there = Case(effects=tuple(h.added(v) for h, v in zip(kinds, (lead, follower), strict=True)))
    objective = objective_of(twin, twin.simulate(there) + white((2, SAMPLES), 8))
    nominal = nominal_fit(objective, {})
    accepted = tuple(
        AcceptedEffect(hypothesis=h, score=1.0, runner_up=None, margin=1.0, rejected=())
        for h in kinds
    )
    fit = gauss_newton_fit(objective, kinds, (lead, follower), {}, rounds=6)
    selection = found_without_spectra(nominal, fit, accepted)
    return objective, selection


def test_slip_on_both_rollers_of_a_pair_alike_is_slip_of_the_pair():
    said = []
    objective, selection = found_beside((0.0021, 0.8), (0.0019, 0.8))
    (h,) = joined(objective, selection, said.append).fit.hypotheses
    assert (h.effect.name, h.location) == ("slip", "swrap")
    (accepted,) = joined(objective, selection, said.append).accepted
    assert accepted.hypothesis == h
    assert "is told as slip at swrap" in said[0]


def test_slip_of_a_pair_has_the_numbers_that_fit_both():
    objective, selection = found_beside((0.002, 0.8), (0.002, 0.8))
    fit = joined(objective, selection, lambda _text: None).fit
    assert fit.values[0] == pytest.approx((0.002, 0.8), rel=0.02)


def test_slip_that_differs_from_roller_to_roller_stays_two():
    objective, selection = found_beside((0.004, 0.8), (0.001, 0.7))
    assert joined(objective, selection, lambda _text: None) == selection


TURN = 0.7 * STEP_S * np.arange(SAMPLES)
AHEAD = {"R1": 0.10, "R2": 0.20}
"""Radians by which an eccentric roller is seen earlier at the second cell."""


def turning(case, turn=TURN):
    both = np.zeros((2, SAMPLES))
    for added in case.effects:
        given = dict(added.parameters)
        for row, ahead in enumerate((0.0, AHEAD.get(added.location, 2.0))):
            both[row] += 1e5 * given["cos_m"] * np.cos(turn + ahead)
            both[row] += 1e5 * given["sin_m"] * np.sin(turn + ahead)
    return both


@pytest.mark.parametrize(("missing_N", "alike"), [(0.0, []), (3.0, ["R1"])])
def test_a_neighbour_that_was_ahead_stays_named_while_something_is_missing(missing_N, alike):
    first, second = (hypothesis(BY_NAME["eccentric_roller"], at, line=LINE) for at in AHEAD)
    twin = formula_twin(turning, ("pullroll_tension_N", "unwind_tension_N"), SAMPLES, line=LINE)
    true = twin.simulate(Case(effects=(second.added((2e-4, 1e-4)),)))
    other = missing_N * np.sin(2.9 * TURN) * np.ones((2, 1))
    objective = objective_of(twin, true + other + white((2, SAMPLES), 8))
    nominal = nominal_fit(objective, {})
    accepted = AcceptedEffect(hypothesis=first, score=1.0, runner_up=None, margin=1.0, rejected=())
    fit = gauss_newton_fit(objective, (first,), ((2e-4, 1e-4),), {})
    selection = found_without_spectra(nominal, fit, (accepted,))
    (found,) = exchanged(objective, selection, lambda _text: None).accepted
    assert found.hypothesis.location == "R2"
    assert [place.location for place in found.ambiguous] == alike


def test_a_place_that_is_moved_to_has_the_scores_of_that_place() -> None:
    """R5 scored 100; R4 explains 30 more than R5, R6 20 less; R7 was not tried again."""
    old, far = EffectAt("eccentric_roller", "R5"), EffectAt("eccentric_roller", "R7")
    new, near = EffectAt("eccentric_roller", "R4"), EffectAt("eccentric_roller", "R6")
    moved = AcceptedEffect(
        hypothesis=hypothesis(BY_NAME["eccentric_roller"], "R4", line=LINE),
        score=100.0,
        runner_up=new,
        margin=2.0,
        rejected=((new, 98.0), (near, 95.0), (far, 60.0)),
        ambiguous=(near,),
    )
    told = scored_at(moved, {new: 30.0, near: -20.0, old: 0.0})
    assert (told.score, told.runner_up, told.margin) == (130.0, near, 50.0)
    assert told.rejected == ((near, 80.0), (old, 100.0), (far, 60.0))  # the open one first


def test_after_an_exchange_the_old_place_is_the_rival_and_the_new_one_none():
    first, second = (hypothesis(BY_NAME["eccentric_roller"], at, line=LINE) for at in AHEAD)
    twin = formula_twin(turning, ("pullroll_tension_N", "unwind_tension_N"), SAMPLES, line=LINE)
    true = twin.simulate(Case(effects=(second.added((2e-4, 1e-4)),)))
    objective = objective_of(twin, true + white((2, SAMPLES), 8))
    accepted = AcceptedEffect(
        hypothesis=first,
        score=7000.0,
        runner_up=second.key,
        margin=1.0,
        rejected=((second.key, 6999.0),),
    )
    nominal = nominal_fit(objective, {})
    fit = gauss_newton_fit(objective, (first,), ((2e-4, 1e-4),), {})
    selection = found_without_spectra(nominal, fit, (accepted,))
    moved = exchanged(objective, selection, lambda _text: None)
    (found,) = moved.accepted
    assert found.hypothesis.key == second.key
    assert found.score == pytest.approx(7000.0 + fit.cost - moved.fit.cost)
    assert found.runner_up == first.key
    assert found.margin == pytest.approx(fit.cost - moved.fit.cost)
    assert second.key not in dict(found.rejected)


def test_a_constant_drag_is_named_at_every_idler_of_its_zone_that_no_reading_parts_from_it():
    first = hypothesis(BY_NAME["bearing_drag"], "R8", line=LINE)
    zone = [f"R{k}" for k in range(1, 10)]

    def braked(case):
        seen = [dict(e.parameters)["constant_N_m"] for e in case.effects if e.location in zone]
        wave = np.sign(np.sin(0.02 * np.arange(SAMPLES)))
        return np.stack([sum(seen) * 50.0 * wave, np.zeros(SAMPLES)])

    twin = formula_twin(braked, ("r3_tension_N", "pullroll_tension_N"), SAMPLES, line=LINE)
    true = twin.simulate(Case(effects=(first.added((0.1,)),)))
    objective = objective_of(twin, true + white((2, SAMPLES), 8))
    accepted = AcceptedEffect(hypothesis=first, score=1.0, runner_up=None, margin=1.0, rejected=())
    selection = Selection(
        nominal=nominal_fit(objective, {}),
        fit=gauss_newton_fit(objective, (first,), ((0.1,),), {}),
        accepted=(accepted,),
        record_axes=(),
        spectra_declared=(),
        spectra_left=(),
    )
    (found,) = exchanged(objective, selection, lambda _text: None).accepted
    assert {found.hypothesis.location, *(p.location for p in found.ambiguous)} == set(zone)


def test_a_place_far_off_that_was_named_is_tried_again_beside_the_others():
    """R1 and R9 act alike on both cells: R9 is no neighbour, and was named as the other answer."""
    first, far = (hypothesis(BY_NAME["eccentric_roller"], at, line=LINE) for at in ("R1", "R9"))

    def alike(case):
        moved = [replace(added, location="R1") for added in case.effects]
        return turning(replace(case, effects=tuple(moved)))

    twin = formula_twin(alike, ("pullroll_tension_N", "unwind_tension_N"), SAMPLES, line=LINE)
    true = twin.simulate(Case(effects=(first.added((2e-4, 1e-4)),)))
    objective = objective_of(twin, true + white((2, SAMPLES), 8))
    accepted = AcceptedEffect(
        hypothesis=first, score=1.0, runner_up=None, margin=1.0, rejected=(), ambiguous=(far.key,)
    )
    selection = Selection(
        nominal=nominal_fit(objective, {}),
        fit=gauss_newton_fit(objective, (first,), ((2e-4, 1e-4),), {}),
        accepted=(accepted,),
        record_axes=(),
        spectra_declared=(),
        spectra_left=(),
    )
    (found,) = exchanged(objective, selection, lambda _text: None).accepted
    assert "R9" in [place.location for place in found.ambiguous]


FASTER = 5.0 * STEP_S * np.arange(SAMPLES)
"""Angle of an idler, rad: 24 turns in the record."""


def at_r2_with(error_N):
    """Return objective and selection of R2, found where the first cell shows more than it does.

    The idler's 22 N are seen 0.1 rad apart by R1 and R2 at the second cell: R1 leaves 1.1 N in
    quadrature on both, a chi-square of 2 (1.1^2 / 2) 2250 = 2.7e3. ``error_N`` in phase on one
    cell leaves half of itself on both: a quarter of ``error_N``^2 by 2250.
    """
    first, second = (hypothesis(BY_NAME["eccentric_roller"], at, line=LINE) for at in AHEAD)
    channels = ("pullroll_tension_N", "unwind_tension_N")
    twin = formula_twin(lambda case: turning(case, FASTER), channels, SAMPLES, line=LINE)
    true = twin.simulate(Case(effects=(second.added((2.2e-4, 0.0)),)))
    error = error_N * np.stack([np.cos(FASTER), np.zeros(SAMPLES)])
    objective = objective_of(twin, true + error + white((2, SAMPLES), 8))
    fit, rival = (gauss_newton_fit(objective, (h,), ((2.2e-4, 0.0),), {}) for h in (second, first))
    rest = SAMPLES - objective.whitening.noise[0].first
    radius_m = LINE.rollers[LINE.body("R2")].radius_m
    nominal = nominal_fit(objective, {})
    score = nominal.cost - fit.cost
    accepted = AcceptedEffect(
        hypothesis=second,
        score=score,
        runner_up=first.key,
        margin=rival.cost - fit.cost,
        rejected=((first.key, score - (rival.cost - fit.cost)),),
    )
    return objective, Selection(
        nominal=nominal,
        fit=fit,
        accepted=(accepted,),
        record_axes=(axes_at(np.full(rest, 5.0 * radius_m), LINE),),
        spectra_declared=(),
        spectra_left=(),
    )


@pytest.mark.parametrize(("error_N", "alike"), [(0.0, []), (1.0, []), (4.0, ["R1"])])
def test_an_error_at_its_own_line_is_as_large_as_a_neighbour_may_be_behind(error_N, alike):
    objective, selection = at_r2_with(error_N)
    (alone,) = with_rivals_at_own_line(objective, selection).accepted
    (beside,) = exchanged(objective, selection, lambda _text: None).accepted
    for found in (alone, beside):
        assert found.hypothesis.location == "R2"
        assert [place.location for place in found.ambiguous] == alike


@pytest.mark.parametrize(("true", "first"), [("unbalanced", "eccentric"), ("eccentric",) * 2])
def test_what_is_wrong_with_a_roller_is_told_anew_beside_the_others(true, first):
    """The other kind was behind while another effect was missing; both are at one wavenumber."""
    kinds = {name: rollers.of_kind(f"{name}_roller", "R4") for name in ("unbalanced", "eccentric")}
    objective, selection = rollers.nothing_found([rollers.put(kinds[true], 2.0, 1.0)])
    other = next(h for name, h in kinds.items() if name != first)
    accepted = AcceptedEffect(
        hypothesis=kinds[first],
        score=7000.0,
        runner_up=other.key,
        margin=1.0,
        rejected=((other.key, 6999.0),),
    )
    fit = gauss_newton_fit(objective, (kinds[first],), (kinds[first].start,), {})
    found = exchanged(objective, replace(selection, fit=fit, accepted=(accepted,)), lambda _: None)
    assert found.accepted[0].hypothesis.key == kinds[true].key
    assert other.key not in found.accepted[0].ambiguous
    assert found.fit.values[0] == pytest.approx(
        [v for _, v in rollers.put(kinds[true], 2.0, 1.0).parameters], rel=0.05
    )


FRICTION_N_M, RADIUS_M = 0.017219, 0.0381
BRAKED = [f"R{k}" for k in range(4, 9)]
BEFORE_CELL = line_with({**{f"rollers.{r}.friction_constant_N_m": 0.3 for r in BRAKED}, "*": 0.0})


def braked(case):
    """Return what a drag does: alike at R4 to R7, a little other at R8, quite other at R1.

    The zero of the cell before them does what those four do.
    """
    phase = 0.5 * STEP_S * np.arange(SAMPLES)
    wave, other = np.sin(phase), np.cos(phase)
    shapes = {"R8": wave + 0.1 * other, "R1": other, "R2": other}
    change = np.zeros(SAMPLES)
    for added in case.effects:
        given = dict(added.parameters)
        size_N = given.get("constant_N_m", 0.0) / RADIUS_M + given.get("offset_N", 0.0)
        change += size_N * shapes.get(added.location, wave)
    for name, shift in case.shifts:
        change += shift * FRICTION_N_M / RADIUS_M * shapes.get(name.split(".")[1], wave)
    return change[None, :]


@pytest.mark.parametrize("shared", [True, False])
def test_an_effect_not_told_from_what_stood_in_is_named_with_all_that_ends_the_conflict(shared):
    drag = hypothesis(BY_NAME["bearing_drag"], "R5", line=BEFORE_CELL)
    cell = EffectAt("load_cell_calibration", "R3")
    twin = formula_twin(braked, ["r3_tension_N"], SAMPLES, line=BEFORE_CELL)
    case = Case(effects=(drag.added((0.04,)),))
    objective = objective_of(twin, twin.simulate(case) + white((1, SAMPLES), 8))
    nominal, fit = nominal_fit(objective, {}), gauss_newton_fit(objective, (drag,), ((0.03,),), {})
    found = AcceptedEffect(
        hypothesis=drag,
        score=nominal.cost - fit.cost,
        runner_up=None,
        margin=1.0,
        rejected=(),
        ambiguous=(cell,),
        shared=shared,
    )
    selection = found_without_spectra(nominal, fit, (found,))
    (told,) = exchanged(objective, selection, quiet).accepted
    places = {p.location for p in told.ambiguous if p.effect == "bearing_drag"}
    assert {"R4", "R6", "R7"} <= places
    assert "R1" not in places
    assert ("R8" in places) is shared
    assert cell in told.ambiguous
