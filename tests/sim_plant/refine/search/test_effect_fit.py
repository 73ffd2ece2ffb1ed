from dataclasses import replace

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.effects.out_of_round_roll import profile
from sim_plant.refine.fit.gauss_newton import gauss_newton_fit
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search.added_effect import certain_size
from sim_plant.refine.search.candidate import Candidate
from sim_plant.refine.search.effect_fit import fit_candidate, profile_reinitialised
from tests.sim_plant.refine.search.roll_formula import (
    DEFAULTS,
    ORDERS,
    RADIUS_M,
    ROLL,
    SAMPLES,
    SPEED_RAD_S,
    coarse_outlines,
    tension,
)
from tests.sim_plant.refine.small import fit_of, formula_twin, objective_of, white

NAMES = ("size_m", "angle_rad", "smoothing_rad")
FLAT = hypothesis(ROLL, "unwind", (("shape", "flat"), ("finest_order", 64.0)), NAMES)
DELAY = hypothesis(BY_NAME["loop_delay"], "unwind")
TRUE_RAD, DELAY_S = 3.0, 0.05


@pytest.fixture(autouse=True, scope="module")
def outlines():
    with coarse_outlines():
        yield


def fit_at(objective, angle_rad):
    """Return flat spot and delay with nothing wrong but the angle."""
    values = ((0.012, angle_rad, 0.0), (DELAY_S,))
    return gauss_newton_fit(objective, (FLAT, DELAY), values, {}, rounds=0)


@pytest.fixture(scope="module")
def objective():
    true = FLAT.added((0.012, TRUE_RAD, 0.0)), DELAY.added((DELAY_S,))
    twin = formula_twin(tension, ["unwind_tension_N"], SAMPLES)
    made = tension(replace(fit_of().case, effects=true))
    return objective_of(twin, made + white((1, SAMPLES)))


def test_a_profile_is_found_anew_once_the_delay_is_known(objective):
    off = fit_at(objective, 2.0)
    near = gauss_newton_fit(objective, off.hypotheses, off.values, {})
    assert near.cost > 100.0 * objective.expected_cost  # from there no step leads to it
    found = profile_reinitialised(objective, near)
    assert found.values[0][1] == pytest.approx(TRUE_RAD, abs=0.01)
    assert found.values[1][0] == pytest.approx(DELAY_S, abs=0.002)
    assert [h.effect.name for h in found.hypotheses] == ["out_of_round_roll", "loop_delay"]
    assert found.cost < 1.1 * objective.expected_cost


def test_a_profile_that_fits_better_as_it_is_stays(objective):
    there = fit_at(objective, TRUE_RAD)
    best = gauss_newton_fit(objective, there.hypotheses, there.values, {})
    unbeaten = replace(best, cost=best.cost - 1.0)
    assert profile_reinitialised(objective, unbeaten) is unbeaten


def test_a_roll_out_of_round_is_located_by_its_orders_and_fitted_as_a_profile(objective):
    orders = hypothesis(ROLL, "unwind")
    first_look = Candidate(
        hypothesis=orders, chi2_reduction=1e6, penalty=100.0, start=orders.start
    )
    nothing = gauss_newton_fit(objective, (), (), {})
    fit = fit_candidate(objective, nothing, first_look)
    values = dict(zip(fit.hypotheses[0].names, fit.values[0], strict=True))
    assert dict(fit.hypotheses[0].fixed)["shape"] == "flat"
    assert values["size_m"] == pytest.approx(0.012, rel=0.1)
    seen = TRUE_RAD + SPEED_RAD_S.mean() * DELAY_S  # the delay is not known yet
    assert values["angle_rad"] == pytest.approx(seen, abs=0.1)


@pytest.mark.parametrize(("spread_N", "known"), [(0.01, True), (2.0, False)])
def test_a_size_that_may_as_well_be_nothing_is_no_estimate(spread_N, known):
    """At 0.03 N, known to 0.01 N, it is three times its spread in one of two components."""
    hum = hypothesis(BY_NAME["mains_hum"], "R9")
    values = tuple({"cos_N": 0.03, "sin_N": 0.03}.get(name, 299.5) for name in hum.names)
    covariance = np.diag([spread_N**2] * len(values))
    fit = replace(fit_of(hum), values=(values,), covariance=covariance)
    assert certain_size(fit) == known


@pytest.mark.long  # quick: a flat spot, above; orders that stay, below
def test_an_outline_that_no_name_has_is_the_nearest_profile_with_what_it_lacks_by_orders():
    """Two bumps of unlike height, 100 degrees apart: no profile of one has these orders."""
    bump = {"shape": "asym", "finest_order": 64.0, "rise_rad": 0.4, "fall_rad": 0.3}
    one, other = (
        profile(RADIUS_M, DEFAULTS | bump | {"size_m": size, "angle_rad": angle}).deviation_m
        for size, angle in ((0.004, 1.0), (0.0025, 1.0 + np.radians(100.0)))
    )
    wanted = (one + other)[:ORDERS]
    true = {}
    for n, h in enumerate(wanted, start=1):
        true |= {f"cos{n}_m": float(h.real), f"sin{n}_m": float(-h.imag)}
    roll = hypothesis(ROLL, "unwind", (("shape", "orders"), ("finest_order", 64.0)), tuple(true))
    made = tension(replace(fit_of().case, effects=(roll.added(tuple(true.values())),)))
    twin = formula_twin(tension, ["unwind_tension_N"], SAMPLES)
    objective = objective_of(twin, made + white((1, SAMPLES)))
    orders = hypothesis(ROLL, "unwind")
    first_look = Candidate(
        hypothesis=orders, chi2_reduction=1e6, penalty=100.0, start=orders.start
    )
    fit = fit_candidate(objective, gauss_newton_fit(objective, (), (), {}), first_look)
    found = fit.hypotheses[0]
    values = dict(found.fixed) | dict(zip(found.names, fit.values[0], strict=True))
    assert "size_m" in found.names
    assert "cos12_m" in found.names
    told = profile(RADIUS_M, DEFAULTS | values).deviation_m[:ORDERS]
    assert told == pytest.approx(wanted, abs=4e-6)
    assert fit.cost < objective.expected_cost + 5.0 * objective.cost_standard_deviation
