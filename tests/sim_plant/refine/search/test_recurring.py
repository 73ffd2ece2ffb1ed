"""A rhythm in how much is left, told from noise, from one line, and by the axis it is on."""

import numpy as np
import pytest

from sim_plant.refine.search.recurring import recurrences, strongest_channel
from tests.sim_plant.refine.small import STEP_S, axes_at, white

JUDGED, PERIOD_S = 6000, 1.36
RAMP = np.linspace(0.6, 1.3, JUDGED)
AXES = axes_at(RAMP)


def louder(position, period, share=0.3, channel=0):
    """Return noise that is thrice as large in a channel for a share of every period."""
    left = white((3, JUDGED), seed=3)
    left[channel] *= np.where(position % period < share * period, 3.0, 1.0)
    return left


def test_noise_that_swells_at_a_period_recurs_in_time():
    left = louder(AXES.time_s, PERIOD_S, channel=2)
    (found,) = recurrences(AXES, left)
    assert (found.axis, 1.0 / found.frequency) == ("time", pytest.approx(PERIOD_S, rel=5e-3))
    assert strongest_channel(left, AXES.time_s, PERIOD_S) == 2


def test_what_recurs_along_the_web_is_not_told_in_time():
    found = recurrences(AXES, louder(AXES.travel_m, PERIOD_S))
    periods = {r.axis: 1.0 / r.frequency for r in found}
    assert "time" not in periods
    assert periods["travel"] == pytest.approx(PERIOD_S, rel=5e-3)


def test_at_one_speed_time_and_travel_are_not_told_apart():
    axes = axes_at(np.full(JUDGED, 0.9))
    found = {r.axis for r in recurrences(axes, louder(axes.time_s, PERIOD_S))}
    assert {"time", "travel"} <= found


def swing(wander):
    """Return noise with a slow swing, its frequency wandering from one swing to the next."""
    phase = np.cumsum(2.0 * np.pi * STEP_S * (0.45 + wander * 0.05 * white(JUDGED, 8).cumsum()))
    return white((3, JUDGED), seed=3) + 2.0 * np.cos(phase)


@pytest.mark.parametrize(
    "left",
    [white((3, JUDGED), seed=3), swing(0.0), swing(0.02)],
    ids=["noise", "one line", "a loop that hunts"],
)
def test_noise_a_line_and_a_hunting_loop_have_no_rhythm(left):
    assert recurrences(AXES, left) == []
