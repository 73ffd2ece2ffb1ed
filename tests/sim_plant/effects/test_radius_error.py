import pytest

from tests.sim_plant.effects.running import at_rest, drawn_tension_N, effect, mean_tension_N


def test_a_radius_believed_too_large_slows_the_roller_and_its_draw() -> None:
    made = at_rest(effect("radius_error", "pull_roll", ratio=1.0003))
    expected_m_s = 1.016 * 1.0005 / 1.0003
    assert made["pull_roll_speed_m_s"].mean() == pytest.approx(expected_m_s, rel=1e-5)
    expected_N = drawn_tension_N(made, 9300.0)
    assert mean_tension_N(made, "R15-pull_roll") == pytest.approx(expected_N, abs=0.02)
