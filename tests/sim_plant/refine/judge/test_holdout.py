import math
from dataclasses import replace

import numpy as np
import pytest

from sim_plant.refine.fit.turning import with_turned
from sim_plant.refine.judge.holdout import evaluate, with_profile_ages
from sim_plant.refine.model.twin import Added, Case
from sim_plant.refine.noise.innovations import noise_model
from tests.sim_plant.refine.small import formula_twin, pool_of, white

SAMPLES = 4000
TURN_RAD = np.linspace(0.0, 400.0, SAMPLES)
NOISE = 0.01 * np.random.default_rng(4).standard_normal((1, SAMPLES))
MODEL = noise_model(0.01 * white((12, 1, SAMPLES), 7), 0, np.zeros(1))


def tension(angle_rad, unwound_m):
    """One order of a roll whose turn is the longer, the smaller the flat on it was made."""
    return np.cos(TURN_RAD * (1.0 + 0.02 * unwound_m) + angle_rad)[None, :]


def pool():
    def formula(case):
        p = dict(case.effects[-1].parameters)
        return tension(p["angle_rad"], p.get("unwound_m", 0.0))

    return pool_of(formula_twin(formula, ["unwind_tension_N"], SAMPLES))


def profile(**more):
    values = {"shape": "flat", "size_m": 0.012, "angle_rad": 0.4, **more}
    return Added("out_of_round_roll", "unwind", tuple(values.items()))


def test_the_roll_of_the_held_out_record_is_taken_as_it_is():
    measured = tension(0.42, 0.013) + NOISE
    case = Case(effects=(profile(unwound_m=0.006),))
    (found,), unwound = with_profile_ages(pool(), measured, case, MODEL)
    p = dict(found.parameters)
    assert p["angle_rad"] == pytest.approx(0.42, abs=0.005)
    assert p["unwound_m"] == pytest.approx(0.013, abs=5e-4)
    assert unwound == {"unwind": p["unwound_m"]}
    assert p["size_m"] == 0.012  # all else is as fitted


def test_a_profile_without_that_number_stays_as_fitted():
    case = Case(effects=(profile(),))
    assert with_profile_ages(pool(), tension(0.42, 0.013), case, MODEL) == (case.effects, {})


def test_what_else_is_on_the_roll_turns_with_it():
    """Two effects of one body have one angle between them, whatever the body's start is."""
    centre = Added("eccentric_roller", "unwind", (("eccentricity_m", 1e-4), ("angle_rad", 1.0)))
    cell = Added("mains_hum", "R9", (("amplitude_N", 0.4), ("phase_rad", 1.0)))
    measured = tension(0.42, 0.013) + NOISE
    effects = (centre, cell, profile(unwound_m=0.006))
    found, _ = with_profile_ages(pool(), measured, Case(effects=effects), MODEL)
    turned = dict(found[2].parameters)["angle_rad"] - 0.4
    assert abs(turned) > 0.01
    now = dict(found[0].parameters)
    assert now["angle_rad"] - 1.0 == pytest.approx(turned)
    assert found[1] == cell


def remembering(case):
    """A tension that forgets what drives held at the start with 1000 samples."""
    held = sum(offset.tension_N for offset in case.start if offset.of == "drive")
    return held * np.exp(-np.arange(SAMPLES) / 1000.0)[None, :]


@pytest.mark.parametrize("rested", [False, True])
def test_how_the_line_of_a_run_held_out_began_counts_as_no_error(rested):
    twin = formula_twin(remembering, ["unwind_tension_N"], SAMPLES, noise_sd=0.25)
    measured = 3.0 * np.exp(-np.arange(SAMPLES) / 1000.0)[None, :] + 0.25 * white((1, SAMPLES), 9)
    there = pool_of(replace(twin, rested=rested))
    found = evaluate(there, measured, (), find_angles=True)
    if rested:  # e^-1 to e^-4 of 3 N are left, by their power 0.4 N
        assert found.rms_amended[0] > 1.8 * found.floor[0]
    else:
        assert found.rms_amended[0] == pytest.approx(found.floor[0], rel=0.05)
    assert found.rms_declared[0] == found.rms_amended[0]  # nothing is claimed


def lump_and_drag(case):
    """A roll of 40 N at 0.8 Hz, and a drag that takes 3 N from its moment on, at 100 Hz."""
    force = np.zeros((1, SAMPLES))
    for added in case.effects:
        given = dict(added.parameters)
        if added.effect == "bearing_drag":
            force += 30.0 * given["constant_N_m"] * (0.01 * np.arange(SAMPLES) >= given["from_s"])
        else:
            force += 40.0 * np.cos(0.05 * np.arange(SAMPLES) + given["angle_rad"])
    return force


def test_a_moment_is_found_beside_a_roll_that_stood_elsewhere():
    """The roll at the fitted angle would leave up to 80 N, in which 3 N have no moment."""
    twin = formula_twin(lump_and_drag, ["unwind_tension_N"], SAMPLES)
    roll = profile()
    drag = Added("bearing_drag", "R7", (("constant_N_m", 0.1), ("from_s", 31.0)), record_index=0)
    true = (with_turned((roll,), "unwind", 2.9)[0], with_begin(drag, 22.7))
    measured = twin.simulate(Case(effects=true)) + white((1, SAMPLES), 11)
    found = evaluate(pool_of(twin), measured, (roll, drag), find_angles=True)
    assert found.moments["bearing_drag at R7"] == pytest.approx(22.7, abs=0.05)
    assert found.angles_rad["unwind"] == pytest.approx(2.9, abs=0.01)
    assert found.rms_amended[0] == pytest.approx(found.floor[0], rel=0.05)


def with_begin(drag, from_s):
    return replace(drag, parameters=(*drag.parameters[:1], ("from_s", from_s)))


def two_idlers(case):
    """Two idlers of one radius that act nearly alike on two cells, 10 N each, at 100 Hz."""
    force = np.zeros((2, SAMPLES))
    turns_rad = 0.13 * np.arange(SAMPLES)
    for added in case.effects:
        given = dict(added.parameters)
        shares = {"R6": (1.0, 0.9), "R7": (0.9, 1.0)}[added.location]
        if added.effect == "mains_hum":
            shares, turned = (0.0, 0.6), 0.47 * np.arange(SAMPLES) + given["phase_rad"]
        else:
            turned = turns_rad + given["angle_rad"]
        force += 10.0 * np.outer(shares, np.cos(turned))
    return force


def idler(location, angle_rad):
    return Added(
        "eccentric_roller", location, (("eccentricity_m", 1e-4), ("angle_rad", angle_rad))
    )


@pytest.mark.parametrize("turned", [(0.0, 3.14), (0.5, 3.0), (2.2, 2.4), (-1.0, 1.1)])
def test_idlers_that_act_nearly_alike_are_turned_together(turned):
    twin = formula_twin(two_idlers, ["unwind_tension_N", "pullroll_tension_N"], SAMPLES)
    fitted = (idler("R6", 0.4), idler("R7", -0.7))
    true = (idler("R6", 0.4 + turned[0]), idler("R7", -0.7 + turned[1]))
    measured = twin.simulate(Case(effects=true)) + white((2, SAMPLES), 3)
    found = evaluate(pool_of(twin), measured, fitted, find_angles=True)
    for place, angle in zip(("R6", "R7"), turned, strict=True):
        assert math.remainder(found.angles_rad[place] - angle, 2.0 * math.pi) == pytest.approx(
            0.0, abs=0.03
        )
    assert found.rms_amended == pytest.approx(found.floor, rel=0.05)


def test_hum_at_a_cell_has_a_phase_of_its_own_beside_its_roller():
    hum = Added("mains_hum", "R7", (("amplitude_N", 6.0), ("phase_rad", 0.2)))
    twin = formula_twin(two_idlers, ["unwind_tension_N", "pullroll_tension_N"], SAMPLES)
    true = (idler("R7", 2.0), replace(hum, parameters=(*hum.parameters[:1], ("phase_rad", 1.7))))
    measured = twin.simulate(Case(effects=true)) + white((2, SAMPLES), 3)
    found = evaluate(pool_of(twin), measured, (idler("R7", 0.0), hum), find_angles=True)
    assert found.angles_rad["R7"] == pytest.approx(2.0, abs=0.01)
    assert found.angles_rad["mains_hum at R7"] == pytest.approx(1.5, abs=0.05)
    assert found.rms_amended == pytest.approx(found.floor, rel=0.05)


def roll_and_motor(case, further_rad=0.0):
    """An ellipse, and a torque c cos(theta) + s sin(theta) of its motor, theta from the record."""
    theta = 0.05 * np.arange(SAMPLES) + further_rad
    force = np.zeros((1, SAMPLES))
    for added in case.effects:
        given = dict(added.parameters)
        if added.effect == "torque_ripple":
            force += given["cos_N_m"] * np.cos(theta) + given["sin_N_m"] * np.sin(theta)
        else:
            force += 8.0 * np.cos(2.0 * (theta + given["angle_rad"]))
    return force


@pytest.mark.parametrize("further_rad", [0.7, 2.4, -1.3])
def test_a_motor_s_ripple_is_found_beside_the_shape_of_its_roll(further_rad):
    """Roll and motor stood further on together; a shape's angle and a ripple's count otherwise."""
    ripple = Added("torque_ripple", "unwind", (("order", 1.0), ("cos_N_m", 5.0), ("sin_N_m", 3.0)))
    fitted = (profile(), ripple)
    twin = formula_twin(roll_and_motor, ["unwind_tension_N"], SAMPLES)
    measured = roll_and_motor(Case(effects=fitted), further_rad) + white((1, SAMPLES), 5)
    found = evaluate(pool_of(twin), measured, fitted, find_angles=True)
    assert found.rms_amended == pytest.approx(found.floor, rel=0.05)


def test_the_corrected_line_has_the_numbers_shifted_and_no_effect():
    def formula(case):
        drag = sum(dict(e.parameters)["constant_N_m"] for e in case.effects)
        shift = dict(case.shifts).get("web.EA_N", 0.0)
        return np.full((1, SAMPLES), 10.0 * drag + shift)

    pool = pool_of(formula_twin(formula, ["unwind_tension_N"], SAMPLES))
    drag = Added("bearing_drag", "R5", (("constant_N_m", 0.3),))
    shifts = (("web.EA_N", 2.0),)
    for shifted, levels in ((shifts, (0.0, 2.0, 5.0)), ((), (0.0, 0.0, 3.0))):
        found = evaluate(pool, np.zeros((1, SAMPLES)), (drag,), shifted, find_angles=False)
        runs = (found.declared, found.corrected, found.amended)
        assert tuple(float(run.mean()) for run in runs) == pytest.approx(levels)
