from dataclasses import replace

import pytest

from sim_plant.effects.out_of_round_roll import profile
from sim_plant.refine.fit.gauss_newton import gauss_newton_fit
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search.profile_name import with_best_name, without_unpaid_orders
from tests.sim_plant.refine.search.roll_formula import (
    DEFAULTS,
    RADIUS_M,
    ROLL,
    SAMPLES,
    coarse_outlines,
    tension,
)
from tests.sim_plant.refine.small import fit_of, formula_twin, objective_of, white

FINEST = ("finest_order", 64.0)
FLATTENED = hypothesis(
    ROLL, "unwind", (("shape", "flattened_bulge"), FINEST), ("size_m", "flat_width_m", "angle_rad")
)
NAMES = FLATTENED.names
BUMP = hypothesis(
    ROLL, "unwind", (("shape", "asym"), FINEST), ("size_m", "rise_rad", "fall_rad", "angle_rad")
)


@pytest.fixture(autouse=True, scope="module")
def outlines():
    with coarse_outlines():
        yield


@pytest.fixture(scope="module")
def pressed_flat():
    """The objective of a bulge of 5 mm that is pressed flat on 40 mm."""
    true = FLATTENED.added([{"size_m": 0.005, "flat_width_m": 0.04}.get(n, 2.0) for n in NAMES])
    twin = formula_twin(tension, ["unwind_tension_N"], SAMPLES)
    made = tension(replace(fit_of().case, effects=(true,)))
    return objective_of(twin, made + white((1, SAMPLES)))


def test_a_profile_that_was_found_under_another_name_is_told_by_its_own(pressed_flat):
    values = {"size_m": 0.006, "rise_rad": 0.4, "fall_rad": 0.4, "angle_rad": 2.0}
    start = (tuple(values[name] for name in BUMP.names),)
    bump = gauss_newton_fit(pressed_flat, (BUMP,), start, {})
    assert bump.cost > 2.0 * pressed_flat.expected_cost
    found = with_best_name(pressed_flat, bump, 0)
    told = dict(zip(found.hypotheses[0].names, found.values[0], strict=True))
    assert dict(found.hypotheses[0].fixed)["shape"] == "flattened_bulge"
    assert told["size_m"] == pytest.approx(0.005, rel=0.03)
    assert told["flat_width_m"] == pytest.approx(0.04, rel=0.1)
    assert found.cost < 1.1 * pressed_flat.expected_cost


def test_a_profile_that_leaves_noise_alone_keeps_its_name(pressed_flat):
    start = (tuple({"size_m": 0.005, "flat_width_m": 0.04}.get(n, 2.0) for n in NAMES),)
    there = gauss_newton_fit(pressed_flat, (FLATTENED,), start, {})
    found = with_best_name(pressed_flat, there, 0)
    assert found.hypotheses[0].fixed == FLATTENED.fixed


ORDER_2 = ("cos2_m", "sin2_m")


def ellipse_with_order_2(beside):
    """Return the objective of an ellipse with ``beside`` (cos, sin) as its truth."""
    names = ("size_m", *ORDER_2, "angle_rad")
    h = hypothesis(ROLL, "unwind", (("shape", "ellipse"), ("finest_order", 64.0)), names)
    true = h.added([{"size_m": 0.0014, "angle_rad": 1.7}.get(n, 0.0) for n in h.names])
    spoilt = hypothesis(ROLL, "unwind", (("shape", "orders"), ("finest_order", 64.0)), beside)
    effects = (true, spoilt.added(tuple(beside.values()))) if beside else (true,)
    made = tension(replace(fit_of().case, effects=effects))
    twin = formula_twin(tension, ["unwind_tension_N"], SAMPLES)
    return h, objective_of(twin, made + white((1, SAMPLES)))


def test_a_profile_that_shares_its_size_with_an_order_has_it_back():
    h, objective = ellipse_with_order_2({})
    true = profile(RADIUS_M, DEFAULTS | {"shape": "ellipse", "size_m": 0.0014, "angle_rad": 1.7})
    half = profile(RADIUS_M, DEFAULTS | {"shape": "ellipse", "size_m": 0.0007, "angle_rad": 1.0})
    rest = (true.deviation_m - half.deviation_m)[1]
    start = {"size_m": 0.0007, "angle_rad": 1.0, "cos2_m": rest.real, "sin2_m": -rest.imag}
    values = (tuple(start[name] for name in h.names),)
    shared = gauss_newton_fit(objective, (h,), values, {}, rounds=0)
    assert shared.cost < objective.expected_cost + 5.0 * objective.cost_standard_deviation
    fit = without_unpaid_orders(objective, shared, 0)
    found = dict(zip(fit.hypotheses[0].names, fit.values[0], strict=True))
    assert set(found) == {"size_m", "angle_rad"}
    assert found["size_m"] == pytest.approx(0.0014, rel=0.01)


def test_orders_that_no_profile_has_stay():
    _, objective = ellipse_with_order_2({"cos3_m": 0.0004, "sin3_m": 0.0002})
    names = ("size_m", "cos3_m", "sin3_m", "angle_rad")
    h = hypothesis(ROLL, "unwind", (("shape", "ellipse"), ("finest_order", 64.0)), names)
    true = {"size_m": 0.0014, "angle_rad": 1.7, "cos3_m": 0.0004, "sin3_m": 0.0002}
    fit = gauss_newton_fit(objective, (h,), (tuple(true[n] for n in h.names),), {})
    assert without_unpaid_orders(objective, fit, 0) is fit
