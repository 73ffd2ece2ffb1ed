import pytest

from tests.sim_plant.effects.running import (
    at_rest,
    drawn_tension_N,
    effect,
    euclid,
    mean_tension_N,
    nominal,
)


@pytest.mark.parametrize("factor", [0.85, 1.2])
@pytest.mark.sweep(every=2)
def test_the_draw_zone_holds_the_tension_of_its_draw_and_the_new_modulus(factor: float) -> None:
    channels = at_rest(effect("web_modulus", "web", factor=factor), seconds=70.0)
    expected_N = drawn_tension_N(channels, factor * euclid().web.EA_N)
    assert mean_tension_N(channels, "R15-pull_roll") == pytest.approx(expected_N, abs=0.03)
    assert abs(expected_N - mean_tension_N(nominal(), "R15-pull_roll")) > 0.5


def test_the_roll_was_wound_at_the_declared_tension_whatever_its_modulus() -> None:
    channels = at_rest(effect("web_modulus", "web", factor=0.85))
    wound_in = euclid().web.wound_in_tension_N / (0.85 * euclid().web.EA_N)
    at_lead = mean_tension_N(channels, "R9-swrap_lead") / (0.85 * euclid().web.EA_N)
    surface_m_s = channels["unwind_speed_rad_s"] * channels["true_unwind_radius_m"]
    expected = channels["true_line_speed_m_s"].mean() * (1.0 + wound_in) / (1.0 + at_lead)
    assert surface_m_s.mean() == pytest.approx(expected, rel=1e-5)
