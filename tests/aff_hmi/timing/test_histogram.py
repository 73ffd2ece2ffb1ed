"""Percentiles against those of the numbers themselves."""

from __future__ import annotations

import numpy as np
import pytest

from aff_hmi.timing.histogram import EDGES_US, PER_DECADE, Histogram, Times

RATIO = 10.0 ** (1.0 / PER_DECADE)


def test_a_percentile_is_never_too_small_and_at_most_a_class_too_large() -> None:
    values = np.random.default_rng(1).lognormal(np.log(800.0), 0.6, 100_000)
    histogram = Histogram()
    for part in np.array_split(values, 17):
        histogram.add(part)
    found = histogram.figures()
    assert found.count == len(values)
    for share, told in ((0.5, found.p50), (0.99, found.p99), (0.999, found.p999)):
        true = np.quantile(values, share, method="inverted_cdf")
        assert told is not None
        assert true <= told <= RATIO * true
    assert found.largest == values.max()


def test_what_is_beyond_the_classes_is_counted_and_told_exactly() -> None:
    histogram = Histogram()
    histogram.add(np.array([1.0, 1e6, np.nan, 5e6]))
    assert histogram.counts[0] == 1
    assert histogram.counts[-1] == 2
    figures = histogram.figures()
    assert (figures.count, figures.p99, figures.largest) == (3, 5e6, 5e6)


def test_before_the_first_tick_nothing_is_told() -> None:
    figures = Histogram().figures()
    assert (figures.count, figures.p50, figures.p99, figures.largest) == (0, None, None, None)


def test_edges_rise_by_one_ratio() -> None:
    assert EDGES_US[0] == 10.0
    assert EDGES_US[-1] == pytest.approx(100_000.0)
    assert np.diff(np.log10(EDGES_US)) == pytest.approx(0.1)


def test_the_last_minute_forgets_what_is_older() -> None:
    times = Times()
    largest = {}
    for second in range(200):
        times.add(np.array([50_000.0 if second == 100 else 500.0]), second)
        largest[second] = times.minute(second).figures().largest
    assert {second for second, one in largest.items() if one == 50_000.0} == set(range(100, 160))
    assert times.minute(199).figures().count == 60
    assert times.minute(229).figures().count == 30
    assert times.whole.figures().largest == 50_000.0
    assert times.whole.figures().count == 200
