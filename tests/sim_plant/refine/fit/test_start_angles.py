"""Effects begin where a record shows them: declared ones, beside others, at any order."""

import math
import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from sim_plant.line.declared.declaration import EffectEntry
from sim_plant.line.reading.load import load_declaration
from sim_plant.refine.fit.start_angles import with_effects_as_the_record_begins
from sim_plant.refine.model.twin import Added, Case, Twin, modelled_channels
from tests.sim_plant.effects.tracing import settling
from tests.sim_plant.refine.small import formula_twin, line_with

LINE = load_declaration(Path(__file__).parents[4] / "config/lines/euclid.yaml")
SAMPLES = 1500
CHANNELS = modelled_channels(LINE, [s.channel for s in LINE.sensors])


@pytest.fixture(autouse=True, scope="module")
def settled_shortly():
    with settling(4.0):
        yield


def twin(*entries):
    line = LINE.model_copy(update={"effects": entries})
    return Twin(
        declaration=line,
        channels=CHANNELS,
        speed_m_s=np.full(SAMPLES, 1.0),
        tension_N=np.full(SAMPLES, 89.0),
        aff_m_s={},
    )


def roller(angle_rad):
    return EffectEntry(
        effect="eccentric_roller",
        location="R6",
        parameters={"eccentricity_m": 3e-4, "angle_rad": angle_rad},
    )


@pytest.mark.parametrize("start_rad", [0.3, 2.5, -1.2])
@pytest.mark.sweep(every=3)
def test_a_declared_roller_begins_where_the_record_shows_it(start_rad):
    measured = twin(roller(start_rad)).simulate(Case(quick=False, seed=3))
    found, angles = with_effects_as_the_record_begins(twin(roller(1.0)), measured)
    (entry,) = found.declaration.effects
    off = math.remainder(entry.parameters["angle_rad"] - start_rad, 2.0 * math.pi)
    assert abs(off) < 0.06
    turned_rad = math.remainder(angles["R6"] - (start_rad - 1.0), 2.0 * math.pi)
    assert turned_rad == pytest.approx(off, abs=1e-9)
    assert entry.parameters["eccentricity_m"] == 3e-4


def test_what_has_no_angle_stays_as_declared():
    stiff = EffectEntry(effect="web_modulus", location="web", parameters={"factor": 1.2})
    there = twin(stiff)
    assert with_effects_as_the_record_begins(there, np.zeros((len(CHANNELS), SAMPLES))) == (
        there,
        {},
    )


@pytest.mark.long  # quick: a declared roller, above
def test_a_profile_declared_without_an_angle_is_turned_too():
    flat = EffectEntry(
        effect="out_of_round_roll", location="unwind", parameters={"shape": "flat", "size_m": 0.01}
    )
    measured = twin(flat.model_copy(update={"parameters": {**flat.parameters, "angle_rad": 2.0}}))
    found, _ = with_effects_as_the_record_begins(
        twin(flat), measured.simulate(Case(quick=False, seed=5))
    )
    (entry,) = found.declaration.effects
    assert math.remainder(entry.parameters["angle_rad"] - 2.0, 2.0 * math.pi) == pytest.approx(
        0.0, abs=0.01
    )


ROWS = 4000
RADIUS = "rollers.unwind.effective_radius"
TURN_RAD = 0.05 * np.arange(ROWS)
"""Of the declared unwind at 100 Hz: 32 turns in 40 s."""


def lump_of_smaller_roll(case):
    """Angle of the unwind, and a tension of its lump; a smaller radius turns it the faster."""
    theta = TURN_RAD / (1.0 + dict(case.shifts).get(RADIUS, 0.0))
    force = np.zeros(ROWS)
    for added in case.effects:
        force += 20.0 * np.cos(theta + dict(added.parameters)["angle_rad"])
    return np.stack([theta, force])


@pytest.mark.parametrize("shift", [-0.004, 0.0, 0.003])
def test_a_declared_profile_is_turned_with_its_roll_in_step(shift):
    """0.4 % of 200 rad are 0.8 rad at the end: out of step the angle is off by half of that."""
    declared, true = (lump(angle_rad) for angle_rad in (0.4, 1.9))
    channels = ("unwind_angle_rad", "unwind_tension_N")
    line = line_with({RADIUS: 0.01, "*": 0.0}, effects=(declared,))
    there = formula_twin(lump_of_smaller_roll, channels, ROWS, noise_sd=(1e-3, 1.0), line=line)
    added = Added(true.effect, true.location, tuple(true.parameters.items()))
    case = Case(effects=(added,), shifts=((RADIUS, shift),), seed=5)
    found, angles = with_effects_as_the_record_begins(there, there.simulate(case))
    (entry,) = found.declaration.effects
    assert entry.parameters["angle_rad"] == pytest.approx(1.9, abs=0.03)
    assert angles["unwind"] == pytest.approx(1.5, abs=0.03)


def lump(angle_rad):
    return EffectEntry(
        effect="out_of_round_roll",
        location="unwind",
        parameters={"shape": "flat", "size_m": 0.01, "angle_rad": angle_rad},
    )


def ripple(order, angle_rad, location="unwind"):
    return EffectEntry(
        effect="torque_ripple",
        location=location,
        parameters={"order": order, "amplitude_N_m": 20.0, "angle_rad": angle_rad},
    )


def ripple_N(case, theta):
    """Return the force of ripples cos(n theta - angle), their amplitude as it is."""
    force = np.zeros(theta.size)
    for added in case.effects:
        p = dict(added.parameters)
        force += p["amplitude_N_m"] * np.cos(p["order"] * theta - p["angle_rad"])
    return force


def power_left(*true):
    """Return the power of what is left at the angles found, over that of the ripples."""

    def formula(case):
        return ripple_N(case, TURN_RAD)[None]

    declared = [
        e.model_copy(update={"parameters": {**e.parameters, "angle_rad": 0.0}}) for e in true
    ]
    line = line_with({"*": 0.0}, effects=tuple(declared))
    there = formula_twin(formula, ("unwind_tension_N",), ROWS, line=line)
    hidden = tuple(Added(e.effect, e.location, tuple(e.parameters.items())) for e in true)
    measured = there.simulate(Case(effects=hidden, seed=5))
    found, _ = with_effects_as_the_record_begins(there, measured)
    shown = tuple(
        Added(e.effect, e.location, tuple(e.parameters.items())) for e in found.declaration.effects
    )
    wanted, got = (ripple_N(Case(effects=e), TURN_RAD) for e in (hidden, shown))
    return float(np.mean((wanted - got) ** 2) / np.mean(wanted**2))


@pytest.mark.parametrize("order", [6.0, 24.0, 36.0, 48.0, 8.5])
@pytest.mark.sweep(every=2)
def test_a_ripple_of_a_high_order_begins_where_the_record_shows_it(order):
    """2 degrees of phase leave 1e-3; at the highest order 24 tries a turn are one phase."""
    phases = np.arange(8) * math.pi / 4.0 + 0.3
    assert max(power_left(ripple(order, float(a))) for a in phases) < 1e-3


@pytest.mark.parametrize(("order", "turned_rad"), [(24.0, 2.294), (36.0, 2.868)])
def test_a_ripple_of_a_high_order_begins_right_beside_a_first_order_of_its_roll(order, turned_rad):
    """Both turn with the roll: an angle of it takes their phases by one and by ``order`` of it."""
    assert power_left(ripple(1.0, turned_rad), ripple(order, order * turned_rad)) < 1e-3


def test_no_more_than_some_tries_are_held_at_a_time():
    """Order 44 beside order 1 of a roll has 176 tries, each as large as the judged 3000 rows."""
    tracemalloc.start()
    try:
        power_left(ripple(1.0, 0.7), ripple(44.0, 44.0 * 0.7))
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < 0.75 * 176 * 3000 * 8
