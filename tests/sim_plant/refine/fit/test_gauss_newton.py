from dataclasses import replace

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import case_of, gauss_newton_fit, jacobian
from sim_plant.refine.model.hypotheses import hypothesis
from tests.sim_plant.refine.small import formula_twin, objective_of, pool_of, white

NUMBER, SD, SAMPLES = "web.EA_N", 0.01, 2000
TIME = np.arange(SAMPLES)
SLOPE, BEND = 400.0 * np.sin(0.05 * TIME), 1000.0 * np.cos(0.05 * TIME)


def straight_line(true_shift):
    """Return the objective of a record that a declared number explains in proportion.

    Also returned: what shifts were simulated on the way.
    """
    twin = formula_twin(lambda case: [SLOPE * shift_of(case)], ["unwind_tension_N"], SAMPLES)
    measured = SLOPE * true_shift + white(SAMPLES)
    objective = objective_of(twin, measured[None])
    twin.simulated.clear()
    return objective, twin


def shift_of(case):
    return dict(case.shifts).get(NUMBER, 0.0)


def ends(twin):
    """Return the shifts that were tried, each once."""
    return list(dict.fromkeys(shift_of(case) for case in twin.simulated))


def test_a_step_within_reason_is_taken_whole():
    objective, twin = straight_line(20 * SD)
    fit = gauss_newton_fit(objective, (), (), {})
    zero = objective.residual([np.zeros((1, SAMPLES))])
    estimate = np.linalg.lstsq(objective.projector.nuisances, zero, rcond=None)[0][0]
    assert estimate == pytest.approx(20 * SD, rel=0.01)
    assert fit.shifts[NUMBER] == pytest.approx(estimate, rel=1e-8)
    assert ends(twin)[0] == pytest.approx(estimate, rel=1e-8)  # 0 is known already


def test_no_line_is_simulated_that_a_step_would_put_far_beyond_its_tolerance():
    objective, twin = straight_line(300 * SD)
    gauss_newton_fit(objective, (), (), {}, rounds=1)
    (tried,) = ends(twin)
    assert 0.0 < tried <= CRITERIA.fit.astray_sd * SD


def test_a_step_that_leads_astray_at_every_length_leaves_the_fit_where_it_was():
    objective, twin = straight_line(5500 * SD)
    assert gauss_newton_fit(objective, (), (), {}).shifts == {}
    assert ends(twin) == []


def bent_line(measured):
    """Return the objective of a record, where a declared number does something of second order."""

    def channels(case):
        shift = shift_of(case)
        return [SLOPE * shift + BEND * shift**2]

    twin = formula_twin(channels, ["unwind_tension_N"], SAMPLES)
    return objective_of(twin, (measured + white(SAMPLES))[None])


@pytest.mark.parametrize("times", [20, -20])
def test_a_number_that_is_truly_far_off_goes_there(times):
    true = times * SD
    fit = gauss_newton_fit(bent_line(SLOPE * true + BEND * true**2), (), (), {})
    assert fit.shifts[NUMBER] == pytest.approx(true, rel=0.01)


def test_a_number_that_would_imitate_a_small_part_of_something_else_stays_where_it_is_declared():
    true = 20 * SD
    objective = bent_line(SLOPE * true + 0.2 * BEND * true**2 + 300.0 * np.sin(0.3 * TIME))
    stays, goes = (
        objective.projector.cost(objective.residual(objective.pool.one(case_of((), (), shifts))))
        for shifts in ({}, {NUMBER: 0.3 * true})
    )
    assert 1000.0 < stays - goes < 0.01 * stays  # it would pay, a little
    assert gauss_newton_fit(objective, (), (), {}).shifts == {}


def test_where_a_whole_step_costs_more_its_shares_are_simulated_together(monkeypatch):
    objective = bent_line(SLOPE * 20 * SD)  # what is linear is explained where it is: bends cost
    together, run = [], objective.pool.run

    def counted(cases, keep=True):
        together.append([shift_of(case) for case in cases])
        return run(cases, keep)

    monkeypatch.setattr(objective.pool, "run", counted)
    assert gauss_newton_fit(objective, (), (), {}, rounds=1).shifts == {}
    zero = objective.residual([np.zeros((1, SAMPLES))])
    estimate = np.linalg.lstsq(objective.projector.nuisances, zero, rcond=None)[0][0]
    (shares,) = [shifts for shifts in together if len(shifts) > 1]
    assert shares == pytest.approx([0.4 * estimate, 0.15 * estimate, 0.05 * estimate], rel=1e-6)


def test_a_number_within_its_tolerance_goes_whatever_else_there_is():
    true = 2.7 * SD
    record = SLOPE * true + BEND * true**2 + 30.0 * np.sin(0.3 * TIME)
    fit = gauss_newton_fit(bent_line(record), (), (), {})
    assert fit.shifts[NUMBER] == pytest.approx(true, rel=0.1)


def test_a_start_that_cannot_be_simulated_costs_infinitely_much_and_is_not_left():
    twin = formula_twin(
        lambda case: [np.full(SAMPLES, np.nan if case.effects else 0.0)],
        ["unwind_tension_N"],
        SAMPLES,
    )
    objective = objective_of(twin, white((1, SAMPLES)))
    h = hypothesis(BY_NAME["unbalanced_roller"], "R6")
    fit = gauss_newton_fit(objective, (h,), (h.start,), {})
    assert fit.cost == float("inf")
    assert fit.values == (h.start,)


def test_where_no_line_runs_a_step_further_on_the_slope_is_taken_a_step_back():
    """A drag of at most 0.1 N m runs; the response is 3 N per N m."""
    h = hypothesis(BY_NAME["bearing_drag"], "R7", (), ("constant_N_m",))
    (step,) = h.increments((0.1,))

    def response(case):
        drag_N_m = dict(case.effects[0].parameters)["constant_N_m"]
        size = 3.0 * drag_N_m if drag_N_m <= 0.1 else np.nan
        return [size * SLOPE]

    twin = formula_twin(response, ["unwind_tension_N"], SAMPLES)
    plain = formula_twin(lambda case: np.zeros((1, SAMPLES)), ["unwind_tension_N"], SAMPLES)
    objective = replace(objective_of(plain, white((1, SAMPLES))), pool=pool_of(twin))
    (column,) = jacobian(objective, (h,), ((0.1,),), {}).T
    assert step > 0.0
    assert column == pytest.approx(objective.whitened([3.0 * SLOPE[None]]), rel=1e-9)
