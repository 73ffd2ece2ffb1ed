import numpy as np
import pytest

from tests.sim_plant.effects.running import (
    at_rest,
    drawn_tension_N,
    effect,
    mean_tension_N,
    nominal,
)


def test_slip_above_its_speed_takes_its_share_of_strain() -> None:
    slipping = at_rest(effect("slip", "pull_roll", slope_s_m=0.001, threshold_m_s=0.5))
    share = 1.0 - 0.001 * (slipping["true_pull_roll_speed_m_s"].mean() - 0.5)
    expected_N = drawn_tension_N(slipping, 9300.0, share)
    assert expected_N < mean_tension_N(nominal(), "R15-pull_roll") - 4.0
    assert mean_tension_N(slipping, "R15-pull_roll") == pytest.approx(expected_N, abs=0.02)


def test_below_its_speed_nothing_slips() -> None:
    still = at_rest(effect("slip", "pull_roll", slope_s_m=0.01, threshold_m_s=1.2))
    assert np.array_equal(still["span_tension_N"], nominal()["span_tension_N"])
