import pytest

from sim_plant.line.arrays.locations import zones
from tests.sim_plant.effects.running import (
    at_rest,
    drawn_tension_N,
    effect,
    euclid,
    mean_tension_N,
)


def test_a_warm_draw_zone_loses_its_free_strain_in_tension() -> None:
    warm = at_rest(effect("thermal_strain", "pull_roll_zone", strain=0.0003))
    expected_N = drawn_tension_N(warm, 9300.0) - 9300.0 * 0.0003
    assert mean_tension_N(warm, "R15-pull_roll") == pytest.approx(expected_N, abs=0.02)


def test_web_cools_where_it_leaves_the_warm_zone() -> None:
    """The lead holds the total strain of what comes, warm, and hands it on cold, hence tighter."""
    warm = at_rest(effect("thermal_strain", "unwind_zone", strain=0.0003))
    assert warm["unwind_tension_N"].mean() == pytest.approx(88.9644, abs=5e-3)
    total = 1.0 + mean_tension_N(warm, "R9-swrap_lead") / 9300.0 + 0.0003
    ratio = (warm["true_swrap_follower_speed_m_s"] / warm["true_line_speed_m_s"]).mean()
    gap = mean_tension_N(warm, "swrap_lead-swrap_follower") / 9300.0
    assert 1.0 + gap == pytest.approx(total * ratio, abs=1e-6)


def test_zones_share_out_the_spans_between_driven_rollers() -> None:
    assert zones(euclid()) == {
        "unwind_zone": list(range(10)),
        "pull_roll_zone": list(range(11, 16)),
        "rewind_zone": list(range(16, 20)),
    }
