"""A reading with a gap is told from one with a lag, another scale, or noise."""

from types import SimpleNamespace

import numpy as np
import pytest

from sim_plant.refine.search.reading_direction import gap_in, play, tensions_by_speeds, zone_at
from tests.sim_plant.refine.small import STEP_S, line_with, white

SAMPLES, FIRST = 4000, 1000
TIME_S = STEP_S * np.arange(SAMPLES)
SWING_N = 1.1 * np.sin(2.6 * TIME_S) + 0.7 * np.sin(4.4 * TIME_S) + 0.5 * np.sin(1.7 * TIME_S)
NOISE_N = 0.1 * white(SAMPLES, seed=2)


def followed(values, half):
    return play(values, np.array([half]))[0]


def lagged(values, lag_s):
    out = np.empty_like(values)
    at = values[0]
    for k, value in enumerate(values):
        at += STEP_S / lag_s * (value - at)
        out[k] = at
    return out


@pytest.mark.parametrize(
    ("reading_N", "gap_N"),
    [
        (followed(SWING_N, 0.5), 1.0),
        (followed(1.0 + SWING_N, 0.3) - 1.0, 0.6),
        (SWING_N, None),
        (lagged(SWING_N, 0.08), None),
        (1.3 * SWING_N, None),
        (0.0 * SWING_N, None),
    ],
    ids=["gap", "smaller gap", "none", "lag", "scale", "dead"],
)
def test_only_a_gap_is_one(reading_N, gap_N):
    found = gap_in(reading_N + NOISE_N, SWING_N, SWING_N, STEP_S, FIRST)
    assert (found is None) is (gap_N is None)
    if gap_N is not None:
        assert found[0] == pytest.approx(gap_N, rel=0.16)  # the grid


def test_play_stands_still_when_its_input_turns_and_follows_half_a_gap_behind():
    up_and_down = np.array([0.0, 1.0, 2.0, 1.5, 1.0, 0.0])
    assert followed(up_and_down, 0.5).tolist() == [0.0, 0.5, 1.5, 1.5, 1.5, 0.5]


def test_the_speeds_at_its_ends_tell_how_a_zone_is_stretched():
    """F = EA dv / v (1 - exp(-v t / L)) of a steady difference of speeds."""
    line = line_with()
    driven = [r for r in line.rollers if r.kind == "driven"]
    speeds = [s for s in line.sensors if getattr(s, "scale_radius_m", None) is not None]
    assert speeds
    assert zone_at(line, line.rollers[1].name) == "unwind_zone"
    unwind = next(s for s in line.sensors if s.channel == "unwind_speed_rad_s")
    first = next(s for s in speeds if s.roller == driven[0].name)
    left = np.zeros((2, SAMPLES))
    left[1] = 1e-3
    twin = SimpleNamespace(
        declaration=line, channels=(unwind.channel, first.channel), speed_m_s=np.full(SAMPLES, 0.8)
    )
    length_m = sum(s.length_m for s in line.spans[: line.body(driven[0].name)])
    expected = line.web.EA_N * 1e-3 / 0.8 * (1.0 - np.exp(-0.8 * TIME_S / length_m))
    found = tensions_by_speeds(twin, left)["unwind_zone"]
    assert found == pytest.approx(expected, abs=2e-3 * expected[-1])
