"""Corrections as inputs of any driven roller, of its speed reference or of its torque."""

import numpy as np
import pytest

from sim_plant.line.open import make_line
from sim_plant.line.reading.load import load_declaration
from tests.lockstep.known_response import ROOT

TICK_S = 0.001
LINE = load_declaration(ROOT / "config/lines/euclid.yaml").model_copy(
    update={"sample_time_s": TICK_S}
)
SPEED_M_S, TENSION_N = 1.0, 89.0
FOLLOWER = "swrap_follower"
INERTIA = next(r.inertia_kg_m2 for r in LINE.rollers if r.name == FOLLOWER)
RADIUS = next(r.radius_m for r in LINE.rollers if r.name == FOLLOWER)
CHANNEL = "true_swrap_follower_speed_m_s"


def speed_change(rows=2, **corrections):
    """Return how much faster the follower turns than without them, rad/s (rows,)."""
    found = []
    for given in ({}, corrections):
        line = make_line(LINE, seed=None, speed_m_s=SPEED_M_S, tension_N=TENSION_N)
        line.settle(4.0)
        out = line.simulate(np.full(rows, SPEED_M_S), np.full(rows, TENSION_N), **given)
        found.append(out[CHANNEL] / RADIUS)
    return found[1] - found[0]


def test_a_torque_turns_its_roller_by_torque_times_time_over_inertia():
    torque_N_m = 0.5
    change = speed_change(aff_N_m={FOLLOWER: np.full(2, torque_N_m)})
    assert change[0] == 0.0  # a row is sampled before its correction acts
    assert change[1] == pytest.approx(torque_N_m * TICK_S / INERTIA, rel=0.02)


def test_a_speed_correction_asks_the_drive_for_its_gain_times_inertia():
    # torque = J K (1 + corner * tick) e with e = v / R  [source 2.24]
    correction_m_s, gain, zeta = 0.01, 20.0, 1.1
    asked = gain * (1.0 + gain / (4.0 * zeta**2) * TICK_S) * correction_m_s / RADIUS
    change = speed_change(aff_m_s={FOLLOWER: np.full(2, correction_m_s)})
    assert change[1] == pytest.approx(asked * TICK_S, rel=0.02)


def test_both_kinds_add_up():
    torque, speed = {FOLLOWER: np.full(2, 0.5)}, {FOLLOWER: np.full(2, 0.01)}
    both = speed_change(aff_m_s=speed, aff_N_m=torque)
    apart = speed_change(aff_m_s=speed) + speed_change(aff_N_m=torque)
    assert both == pytest.approx(apart, rel=1e-3)


def test_the_drives_torque_limit_holds_for_the_sum():
    limit = LINE.control.drive_torque_limit_N_m
    change = speed_change(aff_N_m={FOLLOWER: np.full(2, 10.0 * limit)})
    # the roller itself takes little torque: what is left to the limit accelerates it
    assert change[1] == pytest.approx(limit * TICK_S / INERTIA, rel=0.05)


def test_a_roller_without_a_drive_takes_none():
    with pytest.raises(Exception, match="'R6' has no drive"):
        speed_change(aff_N_m={"R6": np.ones(2)})
