"""Filters of every length are tried, and the shortest that explains a record is taken."""

import numpy as np
import pytest

from sim_plant.refine.without_line.general.effect import OutputRecord
from sim_plant.refine.without_line.general.filter_length import reaches
from sim_plant.refine.without_line.general.search import search
from tests.each_case import each_case

SIZE = 1000


@each_case(
    ("furthest", "centred", "causal"),
    [
        (1, [1], []),
        (3, [1, 2, 3], [3]),
        (20, [1, 2, 4, 10, 20], [4, 10, 20]),
        (50, [1, 2, 4, 10, 20, 50], [4, 10, 20, 50]),
    ],
)
def test_no_filter_reaches_further_than_declared_nor_is_causal_and_of_three_taps(
    furthest, centred, causal
):
    """2 k + 1 taps to both sides of the sample, k + 1 of what came before it."""
    assert reaches(furthest) == [
        *((f"{2 * k + 1} taps, centred", k, k) for k in centred),
        *((f"{k + 1} taps, causal", 0, k) for k in causal),
    ]


def answered(response, first):
    """Return a record of white input whose output is sum_k response[k] u(t - first - k)."""
    draw = np.random.default_rng(5)
    u = draw.standard_normal(SIZE)
    y = sum(gain * np.roll(u, first + k) for k, gain in enumerate(response))
    return OutputRecord(
        output=y + 0.1 * draw.standard_normal(SIZE),
        inputs={"u": u},
        speed_m_s=None,
        step_s=0.01,
        derivative_of_inputs=False,
        end_samples=12,
    )


@pytest.mark.parametrize(("taps", "first", "ahead_and_back"), [(8, 0, (0, 10)), (9, -4, (4, 4))])
def test_the_filter_is_as_long_as_the_record_asks(taps, first, ahead_and_back):
    """Of 1, 2, 4, 10 and 12 samples back, 10 are the first that hold 8 taps from 0 on."""
    found = search([answered(np.ones(taps), first)], lambda _: None)
    assert (found.best.model.ahead, found.best.model.back) == ahead_and_back
