import pytest

from tests.sim_plant.effects.running import (
    at_rest,
    drawn_tension_N,
    effect,
    euclid,
    mean_tension_N,
)

LSB_M = 1e-5


def test_a_radius_believed_too_large_slows_the_roller_and_its_draw() -> None:
    made = at_rest(effect("radius_error", "pull_roll", ratio=1.0003))
    expected_m_s = 1.016 * 1.0005 / 1.0003
    assert made["pull_roll_speed_m_s"].mean() == pytest.approx(expected_m_s, rel=1e-5)
    expected_N = drawn_tension_N(made, 9300.0)
    assert mean_tension_N(made, "R15-pull_roll") == pytest.approx(expected_N, abs=0.02)


def test_a_roll_whose_radius_is_believed_too_large_turns_faster_and_is_read_as_believed() -> None:
    """True radius = believed / ratio: w R carries the same web; it shrinks ratio^2 as fast."""
    made, plain = at_rest(effect("radius_error", "unwind", ratio=1.005)), at_rest()
    turns = (made["unwind_speed_rad_s"] / plain["unwind_speed_rad_s"]).mean()
    assert turns == pytest.approx(1.005, rel=5e-4)
    whole_m = euclid().initial_radii_m.unwind
    shrunk_m = 1.005**2 * (whole_m - plain["unwind_radius_m"][0])
    assert made["unwind_radius_m"][0] == pytest.approx(whole_m - shrunk_m, abs=1.5 * LSB_M)
