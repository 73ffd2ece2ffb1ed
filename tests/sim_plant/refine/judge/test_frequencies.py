"""Hum of another record: the frequency and the phase of the record held out are put in by hand."""

from dataclasses import replace

import numpy as np
import pytest

from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.judge.frequencies import best_shift_Hz, differs_by_record
from sim_plant.refine.judge.holdout import evaluate
from sim_plant.refine.model.twin import Added, Case
from tests.sim_plant.refine.small import STEP_S, formula_twin, pool_of, white

SAMPLES = 8000
TIME_S = STEP_S * np.arange(SAMPLES)
CHANNELS = ["unwind_tension_N", "pullroll_tension_N"]


def hum_and_idler(case):
    """Hum of two cells with their own phases, and an idler that turns at 2.07 Hz."""
    force = np.zeros((2, SAMPLES))
    for added in case.effects:
        given = dict(added.parameters)
        if added.effect == "mains_hum":
            turn = 2.0 * np.pi * given["frequency_Hz"] * TIME_S - given["phase_rad"]
            force += given["amplitude_N"] * np.stack([np.cos(turn), 0.4 * np.cos(turn - 1.1)])
        else:
            force += 5.0 * np.cos(13.0 * TIME_S + given["angle_rad"]) * np.ones((2, 1))
    return force


def hum(frequency_Hz, phase_rad=0.3):
    values = {"amplitude_N": 4.0, "phase_rad": phase_rad, "frequency_Hz": frequency_Hz}
    return Added("mains_hum", "all", tuple(values.items()))


IDLER = Added("eccentric_roller", "R7", (("eccentricity_m", 1e-4), ("angle_rad", 0.0)))
TURNED = replace(IDLER, parameters=(("eccentricity_m", 1e-4), ("angle_rad", 2.2)))


@pytest.mark.parametrize(
    ("fitted_Hz", "true_Hz"), [(59.98, 60.02), (49.9, 49.75), (99.7, 100.05), (50.0, 50.0)]
)
@pytest.mark.sweep(every=3)
def test_mains_of_another_record_are_found_at_their_frequency_and_phase(fitted_Hz, true_Hz):
    twin = formula_twin(hum_and_idler, CHANNELS, SAMPLES)
    measured = twin.simulate(Case(effects=(hum(true_Hz, 2.0), TURNED))) + white((2, SAMPLES), 3)
    found = evaluate(pool_of(twin), measured, (hum(fitted_Hz), IDLER), find_angles=True)
    # Cramer-Rao: sqrt(6) / (pi T A / sd sqrt(N)) is 0.03 mHz; an eighth of a grid step is 0.2
    assert found.frequencies_Hz["mains_hum at all"] == pytest.approx(true_Hz, abs=5e-4)
    assert found.angles_rad["R7"] == pytest.approx(2.2, abs=0.02)
    assert found.rms_amended == pytest.approx(found.floor, rel=0.05)
    assert dict(found.effects[0].parameters)["amplitude_N"] == 4.0  # as fitted


def test_a_line_beyond_what_a_grid_does_is_not_taken_for_the_mains():
    twin = formula_twin(hum_and_idler, CHANNELS, SAMPLES)
    beyond_Hz = 60.0 * (1.0 + 2.0 * CRITERIA.judge.mains_share)
    measured = twin.simulate(Case(effects=(hum(beyond_Hz),))) + white((2, SAMPLES), 3)
    found = evaluate(pool_of(twin), measured, (hum(60.0),), find_angles=True)
    # what is there stays whole, 4 N rms over the root of 2 in the first cell
    assert found.rms_amended[0] > 0.95 * found.rms_declared[0]


def test_on_the_record_that_was_fitted_nothing_is_sought_anew():
    twin = formula_twin(hum_and_idler, CHANNELS, SAMPLES)
    measured = twin.simulate(Case(effects=(hum(60.02),))) + white((2, SAMPLES), 3)
    found = evaluate(pool_of(twin), measured, (hum(60.0),), find_angles=False)
    assert not found.frequencies_Hz
    assert found.effects == (hum(60.0),)


def test_only_what_the_mains_make_has_a_frequency_of_the_record():
    assert differs_by_record(hum(50.0))
    assert not differs_by_record(IDLER)
    assert not differs_by_record(Added("roll_bounce", "unwind", ()))


def test_the_strongest_line_within_the_bound_is_taken():
    turns = 2.0 * np.pi * TIME_S
    product = np.exp(0.05j * turns) + 3.0 * np.exp(0.3j * turns)
    assert best_shift_Hz(product, STEP_S, 0.2) == pytest.approx(0.05, abs=2e-3)
    assert best_shift_Hz(product, STEP_S, 0.4) == pytest.approx(0.3, abs=2e-3)
