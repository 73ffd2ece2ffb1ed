"""One more effect: a number that no record shows says nothing against the effect."""

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.fit.gauss_newton import nominal_fit
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.model.twin import Case
from sim_plant.refine.search.added_effect import with_effect
from tests.sim_plant.refine.small import STEP_S, formula_twin, line_with, objective_of, white

SAMPLES = 3000
WAVE = np.sin(2.0 * np.pi * 0.5 * STEP_S * np.arange(SAMPLES))
LINE = line_with()
SHAFT = hypothesis(BY_NAME["shaft_compliance_backlash"], "unwind", line=LINE)


def fitted(play_seen, start, truth=(0.003, 0.004)):
    """Return a shaft fitted where its twist shows, and its play only if ``play_seen``."""

    def readings(case):
        found = np.zeros((1, SAMPLES))
        for added in case.effects:
            given = dict(added.parameters)
            found += 500.0 * given["compliance_rad_N_m"] * WAVE
            found += play_seen * 500.0 * given["backlash_rad"] * WAVE**2
        return found

    twin = formula_twin(readings, ("unwind_tension_N",), SAMPLES, line=LINE)
    there = Case(effects=(SHAFT.added(truth),))
    objective = objective_of(twin, twin.simulate(there) + white((1, SAMPLES), 8))
    return with_effect(objective, nominal_fit(objective, {}), SHAFT, start, {})


@pytest.mark.parametrize("play_rad", [0.003, 0.1])
def test_play_that_no_record_shows_is_left_out_and_the_shaft_stays(play_rad):
    """Also from the bound of 0.1 rad: before, a number at its bound took the shaft with it."""
    fit = fitted(False, (0.0015, play_rad))
    (h,) = fit.hypotheses
    assert h.names == ("compliance_rad_N_m",)
    assert dict(h.fixed)["backlash_rad"] == 0.0
    assert fit.values[0][0] == pytest.approx(0.003, rel=0.05)


def test_play_that_shows_is_a_number_of_the_shaft():
    fit = fitted(True, (0.0015, 0.003))
    assert fit.hypotheses[0].names == ("compliance_rad_N_m", "backlash_rad")
    assert fit.values[0] == pytest.approx((0.003, 0.004), rel=0.05)


SPEED_M_S = np.interp(STEP_S * np.arange(SAMPLES), [0.0, 15.0, 18.0, 30.0], [1.0, 1.0, 1.25, 1.25])
ROLLER = hypothesis(BY_NAME["slip"], "pull_roll", line=LINE)


@pytest.mark.parametrize("threshold_m_s", [0.0, 0.5])
def test_slip_whose_mean_a_radius_takes_is_found_with_its_slope(threshold_m_s):
    """The web loses s (v - w) of its speed v, 8130 N times that of its tension.

    A radius, known to 0.1 %, takes any part that no speed changes, so the threshold w tells
    nothing and may come to standstill; the slope does not change by it.
    """

    def readings(case):
        wider = dict(case.shifts).get("rollers.pull_roll.radius_m", 0.0)
        found = np.full(SAMPLES, 8130.0 * wider)
        for added in case.effects:
            slope, threshold = dict(added.parameters).values()
            found = found - 8130.0 * slope * np.maximum(SPEED_M_S - threshold, 0.0)
        return found[None]

    line = line_with({"*": 0.0, "rollers.pull_roll.radius_m": 0.002})
    twin = formula_twin(readings, ("pullroll_tension_N",), SAMPLES, line=line, noise_sd=0.25)
    there = Case(effects=(ROLLER.added((0.0024, threshold_m_s)),))
    objective = objective_of(twin, twin.simulate(there) + 0.25 * white((1, SAMPLES), 8))
    fit = with_effect(objective, nominal_fit(objective, {}), ROLLER, (0.0023, 0.0), {})
    assert fit is not None
    assert fit.values[0][0] == pytest.approx(0.0024, rel=0.05)
    assert fit.cost - objective.expected_cost < 4.0 * np.sqrt(2.0 * objective.expected_cost)


def test_a_number_that_is_another_one_all_the_while_is_no_number_that_changes():
    """A record is judged from its first quarter on: what lies before begins in none of it."""
    gain = hypothesis(
        BY_NAME["changed_number"], "sensors.low_pass_Hz", fitted=("change", "from_s"), line=LINE
    )
    assert gain.moment_parameter == "from_s"
    off = [gain.is_number_off((0.1, at_s), 7.5) for at_s in (-1.0, 5.0, 7.5, 8.0)]
    assert off == [True, True, True, False]
    drag = hypothesis(BY_NAME["bearing_drag"], "R5", fitted=("constant_N_m", "from_s"), line=LINE)
    assert not drag.is_number_off((0.1, -1.0), 7.5)  # one that drags from the start is an effect
