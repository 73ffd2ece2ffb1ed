import numpy as np
import pytest

from sim_plant.refine.judge.moments import with_moments
from sim_plant.refine.model.twin import Added, Case
from tests.sim_plant.refine.small import STEP_S, formula_twin, objective_of, pool_of, white

CHANNELS = ("unwind_tension_N", "pullroll_tension_N")
SAMPLES = 6000
TRAVEL_M = STEP_S * np.arange(SAMPLES)
SEAM = Added(
    "splice", "web", (("step_m", 5e-4), ("piece_m", 0.1), ("at_length_m", 50.0)), record_index=0
)


def seam(case):
    """A seam pulses for its length where it passes one cell, and 8 m later at the other."""
    both = np.zeros((2, SAMPLES))
    for added in case.effects:
        given = dict(added.parameters)
        for channel, metres in enumerate((0.0, 8.0)):
            later_m = TRAVEL_M - given["at_length_m"] - metres
            passing = (later_m >= 0.0) & (later_m < given["piece_m"])
            both[channel] += 4e4 * given["step_m"] * passing
    return both


def judged(passed_m):
    """Return the moment found in a record in which the seam passed at ``passed_m``, or none."""
    twin = formula_twin(seam, CHANNELS, SAMPLES)
    true = Case() if passed_m is None else Case(effects=(moved(passed_m),))
    measured = twin.simulate(true) + white((2, SAMPLES), 6)
    objective = objective_of(twin, measured)
    model = objective.whitening.noise[0]
    _, moments = with_moments(pool_of(twin), measured, Case(effects=(SEAM,)), model)
    return moments.get("splice at web"), STEP_S * model.first


def moved(passed_m):
    given = {**dict(SEAM.parameters), "at_length_m": passed_m}
    return Added("splice", "web", tuple(given.items()))


@pytest.mark.parametrize("passed_m", [13.63, 27.3, 44.97])
def test_a_seam_is_found_where_it_passed_before_the_judged_part_or_in_it(passed_m):
    found, first_m = judged(passed_m)
    assert first_m == pytest.approx(15.0)
    assert found == pytest.approx(passed_m, abs=0.06)


def test_a_seam_that_a_record_does_not_have_is_left_out():
    found, _ = judged(None)
    assert found is None or found < 9.0  # long gone when the judged part begins


def step(case):
    """A drag takes steady force from one channel from its moment on."""
    force = np.zeros((2, SAMPLES))
    for added in case.effects:
        given = dict(added.parameters)
        force[0] += 20.0 * given["constant_N_m"] * (STEP_S * np.arange(SAMPLES) >= given["from_s"])
    return force


def drag(from_s):
    return Added("bearing_drag", "R7", (("constant_N_m", 0.1), ("from_s", from_s)), record_index=0)


@pytest.mark.parametrize("there", [True, False])
def test_what_began_before_the_judged_part_is_known_by_its_steady_force(there):
    twin = formula_twin(step, CHANNELS, SAMPLES)
    true = Case(effects=(drag(9.3),)) if there else Case()
    measured = twin.simulate(true) + white((2, SAMPLES), 8)
    model = objective_of(twin, measured).whitening.noise[0]
    effects, moments = with_moments(pool_of(twin), measured, Case(effects=(drag(31.0),)), model)
    assert model.first * STEP_S == pytest.approx(15.0)
    if there:
        assert moments["bearing_drag at R7"] < 15.1
    else:
        left = twin.simulate(Case(effects=effects))[0]
        assert np.all(left[model.first : -20] == 0.0)


def two_steps(case):
    """Drags of two idlers take force from two channels, R5 little of it and R7 much."""
    force = np.zeros((2, SAMPLES))
    for added in case.effects:
        given = dict(added.parameters)
        begun = STEP_S * np.arange(SAMPLES) >= given["from_s"]
        shares = (20.0, 8.0) if added.location == "R5" else (8.0, 20.0)
        force += given["constant_N_m"] * np.outer(shares, begun)
    return force


def drag_at(roller, constant_N_m, from_s):
    given = (("constant_N_m", constant_N_m), ("from_s", from_s))
    return Added("bearing_drag", roller, given, record_index=0)


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_two_events_are_found_whichever_is_looked_for_first(order):
    """At 25 and 44 s, 4 and 10 N in their own channel; fitted where the other one is there."""
    fitted = (drag_at("R5", 0.2, 44.0), drag_at("R7", 0.5, 26.0))
    true = (drag_at("R5", 0.2, 25.0), drag_at("R7", 0.5, 44.0))
    twin = formula_twin(two_steps, CHANNELS, SAMPLES)
    measured = twin.simulate(Case(effects=true)) + white((2, SAMPLES), 8)
    model = objective_of(twin, measured).whitening.noise[0]
    given = Case(effects=tuple(fitted[k] for k in order))
    _, moments = with_moments(pool_of(twin), measured, given, model)
    assert moments["bearing_drag at R5"] == pytest.approx(25.0, abs=0.06)
    assert moments["bearing_drag at R7"] == pytest.approx(44.0, abs=0.06)
