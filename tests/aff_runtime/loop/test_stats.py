from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from aff_runtime.loop.stats import CycleStats, Histogram


@given(st.lists(st.integers(0, 10**11), min_size=1, max_size=200), st.floats(0.01, 1.0))
def test_quantiles_lie_within_one_bin_above_the_exact_ones(
    durations_ns: list[int], share: float
) -> None:
    histogram = Histogram()
    for duration_ns in durations_ns:
        histogram.add(duration_ns)
    exact = float(np.quantile(durations_ns, share, method="inverted_cdf"))
    assert exact <= histogram.quantile_ns(share) <= exact * (1 + 1 / 16) + 1
    assert histogram.max_ns == max(durations_ns)
    assert histogram.count == len(durations_ns)


@pytest.mark.parametrize("duration_ns", [-5, 10**18])
def test_durations_out_of_range_are_counted_at_the_edge(duration_ns: int) -> None:
    histogram = Histogram()
    histogram.add(duration_ns)
    assert histogram.count == 1
    assert histogram.max_ns == max(duration_ns, 0)


def test_an_empty_histogram_says_zero() -> None:
    assert Histogram().quantile_ns(0.99) == 0


def test_the_size_does_not_grow() -> None:
    stats = CycleStats()
    bins = len(stats.io._bins)
    for k in range(5000):
        stats.add(wake_ns=k, io_ns=k * 1000, tick_ns=k * 2000)
    assert len(stats.io._bins) == bins
    assert (stats.wake.count, stats.io.max_ns, stats.tick.max_ns) == (5000, 4_999_000, 9_998_000)
