"""Full rolls on the run: radii of the start, rims at web speed, nothing felt by the web."""

from __future__ import annotations

import pytest

from sim_plant.line import open_line
from tests.sim_plant.line.lines import LINES

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
