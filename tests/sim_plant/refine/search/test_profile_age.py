from dataclasses import replace

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.model.twin import Case
from sim_plant.refine.search.profile_age import (
    formation_starts,
    knows,
    likeliest_age,
    with_formation_radius,
)
from tests.each_case import each_case
from tests.sim_plant.refine.small import fit_of, formula_twin, line_with, objective_of, white


def profile(roll="unwind"):
    line = line_with()
    return hypothesis(
        BY_NAME["out_of_round_roll"], roll, (("shape", "flat"),), ("size_m", "angle_rad"), line
    )


@each_case(
    ("costs", "kept"),
    [
        ((900.0, 800.0), 0.012),
        ((800.0, 900.0), 0.006),
        ((1099.0, 1098.0), 0.012),
        ((1200.0, 1101.0), None),
        ((), None),
    ],
)
def test_a_strong_profile_is_as_old_as_fits_best_unless_that_is_clearly_worse(costs, kept):
    aged = [
        fit_of(cost=cost, shifts={"age": m})
        for cost, m in zip(costs, (0.006, 0.012), strict=False)
    ]
    found = likeliest_age(fit_of(cost=1000.0), aged, sure_excess=100.0)
    assert found.shifts.get("age") == kept


SAMPLES = 1600
TURN_RAD = np.linspace(0.0, 120.0, SAMPLES)


def tension(case):
    """Return one order of a roll whose turn is the longer, the smaller the flat was made."""
    found = np.zeros(SAMPLES)
    for effect in case.effects:
        p = dict(effect.parameters)
        turn = TURN_RAD * (1.0 + 0.5 * p.get("unwound_m", 0.0)) + p.get("angle_rad", 0.0)
        found += 4e4 * p["size_m"] * np.cos(turn)
    return found[None, :]


def aged(size_m, unwound_m=0.012, formula=tension):
    """Return the objective of a record of such a roll, and a fit that knows no age."""
    h = profile()
    true = {"size_m": size_m, "angle_rad": 0.5, "unwound_m": unwound_m}
    wide = hypothesis(h.effect, "unwind", h.fixed, tuple(true), line_with())
    made = formula(Case(effects=(wide.added([true[n] for n in wide.names]),)))
    twin = formula_twin(formula, ["unwind_tension_N"], SAMPLES)
    objective = objective_of(twin, made + white((1, SAMPLES)))
    values = ((size_m, 0.8),)
    run = objective.pool.one(Case(effects=(h.added(values[0]),)))
    cost = objective.projector.cost(objective.residual(run))
    return objective, fit_of(h, values=values, cost=cost), twin


def test_the_age_of_a_strong_profile_is_found_with_its_angle():
    objective, fit, _ = aged(size_m=0.012)
    found = with_formation_radius(objective, fit, 0)
    values = dict(zip(found.hypotheses[0].names, found.values[0], strict=True))
    assert values["unwound_m"] == pytest.approx(0.012, abs=2e-4)
    assert values["angle_rad"] == pytest.approx(0.5, abs=0.01)
    assert found.cost == pytest.approx(objective.expected_cost, rel=0.15)


def test_a_profile_whose_age_hardly_shows_is_fitted_at_none():
    """An ellipse has no corners: its turn is nearly the same, whatever it was made on."""

    def ageless(case):
        return tension(replace(case, effects=tuple(map(hardly_aged, case.effects))))

    objective, fit, twin = aged(size_m=0.012, unwound_m=0.0, formula=ageless)
    twin.simulated.clear()
    assert with_formation_radius(objective, fit, 0) is fit
    sizes = {dict(e.parameters)["size_m"] for c in twin.simulated for e in c.effects}
    assert len(sizes) == 2  # where a fit would begin, and a step of its slope


def hardly_aged(effect):
    rows = tuple((n, 1e-5 * v if n == "unwound_m" else v) for n, v in effect.parameters)
    return replace(effect, parameters=rows)


def test_a_weak_profile_is_not_asked_where_it_was_formed():
    objective, fit, twin = aged(size_m=2e-4)
    twin.simulated.clear()
    assert with_formation_radius(objective, fit, 0) is fit
    assert [case.effects for case in twin.simulated] == []  # the line without it was known


@pytest.mark.parametrize(("roll", "sign"), [("unwind", 1.0), ("rewind", -1.0)])
def test_a_roll_that_winds_up_was_smaller_when_its_profile_was_formed(roll, sign):
    objective, _, _ = aged(size_m=2e-4)
    fit = fit_of(profile(roll), values=((0.01, 0.0),))
    starts = [
        dict(zip(there.hypotheses[0].names, there.values[0], strict=True))["unwound_m"]
        for there in formation_starts(objective, fit, 0, profile(roll).effect.profiles)
    ]
    assert [sign * m for m in starts] == [0.006, 0.012]


@pytest.mark.parametrize(("sigma_m", "known"), [(0.002, True), (0.02, False)])
def test_an_age_that_may_be_any_is_no_number(sigma_m, known):
    """Possible are 0 to 50 mm: an interval as wide says nothing."""
    h = hypothesis(
        BY_NAME["out_of_round_roll"], "unwind", (), ("size_m", "unwound_m"), line_with()
    )
    fit = replace(fit_of(h, values=((0.01, 0.005),)), covariance=np.diag([1e-8, sigma_m**2]))
    assert knows(fit, 0, "unwound_m") == known
