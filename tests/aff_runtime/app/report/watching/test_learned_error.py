"""The error of what a law learned: against draws of a law that forgets, and what a site says."""

import math

import numpy as np
import pytest

from aff_runtime.app.report.watching.learned_error import (
    block_memory_s,
    mean_and_error,
    shape_memory_s,
)
from aff_runtime.base.yaml_section import Section

STEP_S, DRAWS, SIZE, WANDERS = 0.02, 2000, 180.0, 5.0
ACTUATOR = Section(
    {
        "memory_turns": 12,
        "blocks": [
            {"roll": "r6", "orders": [2], "settle_s": "60 s"},
            {"roll": "r6", "orders": [1], "settle_s": 4},
        ],
    }
)


def learned(seconds, memory_s):
    """Return draws of a first-order filter of white noise about a size, in its steady state."""
    rng = np.random.default_rng(3)
    kept = math.exp(-STEP_S / memory_s)
    off = rng.standard_normal(DRAWS)
    found = np.empty((round(seconds / STEP_S), DRAWS))
    for row in found:
        off = kept * off + math.sqrt(1.0 - kept**2) * rng.standard_normal(DRAWS)
        row[:] = off
    return SIZE + WANDERS * found.T


@pytest.mark.parametrize(("seconds", "memory_s"), [(11.5, 1.0), (60.0, 15.0), (10.0, 7.5)])
def test_the_error_is_how_far_means_of_draws_lie_apart(seconds, memory_s):
    """In the mean square; a stretch of one memory and a half tells it no worse in the mean."""
    draws = learned(seconds, memory_s)
    found = np.array([mean_and_error(one, seconds, memory_s) for one in draws])
    apart = float(np.std(draws.mean(axis=1)))
    assert found[:, 0] == pytest.approx(draws.mean(axis=1))
    assert float(np.sqrt(np.mean(found[:, 1] ** 2))) == pytest.approx(apart, rel=0.07)


def test_what_is_no_number_is_left_out_and_of_nothing_nothing_is_known():
    values = np.array([1.0, np.nan, 3.0])
    assert mean_and_error(values, 10.0, 1.0)[0] == 2.0
    for known in (mean_and_error(values, 10.0, math.nan), mean_and_error(values[:1], 10.0, 1.0)):
        assert all(map(math.isnan, known))


def test_a_block_learns_with_a_quarter_of_its_settling_time():
    """exp(-4) is left of the ripple after it."""
    assert block_memory_s(ACTUATOR, ("r6", 1)) == pytest.approx(1.0)
    assert block_memory_s(ACTUATOR, ("r6", 2)) == pytest.approx(15.0)
    assert math.isnan(block_memory_s(ACTUATOR, ("r6", 3)))


def test_law_shape_learns_within_so_many_turns_of_its_roll():
    assert shape_memory_s(ACTUATOR, 0.25) == pytest.approx(3.0)
    assert shape_memory_s(Section(), 1.0) == 9.0  # the model's default
