"""Full rolls on the run: radii of the start, rims at web speed, nothing felt by the web."""

from __future__ import annotations

import numpy as np
import pytest

from sim_plant.line import open_line
from sim_plant.line.open import make_line
from tests.sim_plant.line.lines import LINES, declared, with_effect

LINE = LINES / "euclid.yaml"


def test_a_change_of_rolls_at_speed_keeps_speed_and_tension():
    line = open_line(LINE, seed=None, speed_m_s=0.6)
    lay, y = line.layout, line.state.y
    y[lay.radius] = 0.12
    y[lay.omega] *= 0.2032 / 0.12
    for _ in range(3000):  # 15 s
        line.step({})
    rim_m_s = y[lay.radius] * y[lay.omega]
    assert y[lay.radius] < 0.119
    line.change_rolls()
    assert y[lay.radius] == pytest.approx(0.2032, abs=1e-12)
    assert y[lay.radius + 1] == pytest.approx(0.12, abs=1e-12)
    assert y[lay.radius] * y[lay.omega] == pytest.approx(rim_m_s, rel=1e-12)
    for _ in range(2000):
        seen = line.step({})
        # 20 lbf = 88.96 N at the operating point; a few newton while the drive settles
        assert seen["true_unwind_tension_N"] == pytest.approx(88.96, abs=4.0)
    assert seen["true_unwind_speed_rad_s"] == pytest.approx(0.6 / 0.2032, rel=0.02)


@pytest.mark.parametrize("play_rad", [0.0, 0.004])
def test_a_shaft_that_twists_is_not_felt_when_rolls_change(play_rad):
    """Torque goes with R, so K (twist -+ b/2) does; the play is the same angle on either roll."""
    shaft = {"compliance_rad_N_m": 6e-3, "backlash_rad": play_rad}
    line = make_line(
        with_effect(declared("euclid"), "shaft_compliance_backlash", "unwind", **shaft), seed=None
    )
    line.settle(8.0)
    lay, y = line.layout, line.state.y
    y[lay.omega] /= 0.6
    y[lay.motor] /= 0.6
    y[lay.radius] *= 0.6
    rows = np.full(2000, 1.016), np.full(2000, 88.9644)
    before_N = float(line.simulate(*rows)["span_tension_N"][-1, 0])
    used_m, beyond_rad = float(y[lay.radius]), y[lay.twist] + 0.5 * play_rad  # the unwind brakes
    assert beyond_rad < -0.01
    line.change_rolls()
    share = y[lay.radius] / used_m
    assert y[lay.twist] + 0.5 * play_rad == pytest.approx(share * beyond_rad, rel=1e-9)
    after_N = line.simulate(*(row[:600] for row in rows))["span_tension_N"][:, 0]
    assert np.max(np.abs(after_N - before_N)) < 1.0


@pytest.mark.parametrize("twist_rad", [0.001, -0.001, 0.0])
def test_a_shaft_within_its_play_stays_there_when_rolls_change(twist_rad):
    shaft = {"compliance_rad_N_m": 6e-3, "backlash_rad": 0.004}
    line = make_line(
        with_effect(declared("euclid"), "shaft_compliance_backlash", "unwind", **shaft), seed=None
    )
    lay, y = line.layout, line.state.y
    y[lay.radius] = 0.12
    y[lay.twist] = twist_rad
    line.change_rolls()
    assert y[lay.twist] == twist_rad
