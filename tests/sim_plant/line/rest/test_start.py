"""A line begins where it rests, with corrections and effects that stand still."""

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.line.arrays.build import build_arrays, timing_of
from sim_plant.line.arrays.corrections import apply_corrections
from sim_plant.line.arrays.with_effects import apply_effects
from sim_plant.line.declared.declaration import EffectEntry
from sim_plant.line.running.simulation import LineSimulation
from tests.sim_plant.line.lines import declared

STANDING = [
    ("thermal_strain", "pull_roll_zone", {"strain": 7e-4}),
    ("thermal_strain", "unwind_zone", {"strain": -3e-4}),
    ("web_modulus", "web", {"factor": 0.7}),
    ("wound_in_strain", "unwind", {"strain": 1e-3}),
    ("bearing_drag", "R5", {"constant_N_m": 0.05}),
    ("load_cell_calibration", "R9", {"gain": 1.05, "offset_N": 3.0}),
    ("radius_error", "pull_roll", {"ratio": 1.0004}),
    ("slip", "pull_roll", {"slope_s_m": 3e-4, "threshold_m_s": 0.2}),
]
LEAST_N = 0.1
CORRECTED = {
    "control.pull_roll_draw": 3e-4,
    "web.EA_N": -0.1,
    "rollers.unwind.effective_radius": 2e-3,
    "sensors.rewind_tension_N.offset": -2.0,
}


def started(effects=(), corrections=None):
    """Return a noise-free line as it starts, not settled."""
    line = declared("euclid")
    arrays = build_arrays(line, timing_of(line, line.sample_time_s))
    arrays = apply_corrections(line, arrays, corrections or {})
    entries = [EffectEntry(effect=e, location=at, parameters=p) for e, at, p in effects]
    arrays = apply_effects(line, arrays, entries)
    return LineSimulation(line, seed=None, arrays=arrays, line_speed_m_s=1.3, tension_N=88.9644)


def tensions(line, samples=6000):
    """Return all span tensions (samples, spans), N, from the start on."""
    run = line.simulate(np.full(samples, 1.3), np.full(samples, 88.9644))
    return run["span_tension_N"][2:]


@pytest.fixture(scope="module")
def healthy():
    return tensions(started())


def transient(line, healthy):
    """Return by how much (N) the tensions move in 60 s beside the healthy line's."""
    apart = tensions(line) - healthy
    return np.abs(apart - apart[-1]).max()


@pytest.mark.parametrize(("effect", "location", "parameters"), STANDING)
@pytest.mark.sweep(every=2)
def test_an_effect_that_stands_still_makes_no_transient(effect, location, parameters, healthy):
    assert transient(started([(effect, location, parameters)]), healthy) < LEAST_N


def test_corrections_of_declared_numbers_make_no_transient(healthy):
    assert transient(started(corrections=CORRECTED), healthy) < LEAST_N


def test_web_that_is_warm_between_two_speeds_pulls_less_by_its_free_strain(healthy):
    warm = started([STANDING[0]])
    fall = healthy[0] - tensions(warm, samples=10)[0]
    zone = np.flatnonzero(warm.arrays.spans["free_strain"])
    assert fall[zone] == pytest.approx(warm.arrays.spans["EA_N"][zone] * 7e-4, rel=1e-6)
    assert np.abs(np.delete(fall, zone)).max() < 1e-6


def test_numbers_that_no_line_has_end_in_a_refusal_and_nothing_else():
    """A fit that goes astray tries such numbers: negative radii and stiffness, inertia of -112."""
    line = started(
        corrections={
            "web.EA_N": -55.5,
            "rollers.unwind.effective_radius": -1.08,
            "web.thickness_m": 10.8,
            "idlers.inertia_kg_m2": -112.0,
            "control.drives.swrap_lead.K_ref_rad_s": -114.0,
        }
    )
    with pytest.raises(PlantError, match="diverged"):
        line.settle(10.0)
