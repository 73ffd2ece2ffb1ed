"""Slopes over weeks: expected are the formulas of least squares, and what chance does to them."""

import math

import numpy as np
import pytest
from scipy import stats

from aff_runtime.app.report.watching.trend import FEWEST_READINGS, jump, slope

DAYS = np.arange(42.0)
FEW_AND_MANY = pytest.mark.parametrize("lines", [30, pytest.param(100, marks=pytest.mark.long)])


def readings(growth=0.0, scatter=1.0, own=0.1, seed=1, at=DAYS, exchange=None):
    """Sizes that grow, scatter from day to day, and fall by ``exchange[1]`` on a day."""
    rng = np.random.default_rng(seed)
    size = 40.0 + growth * at + math.hypot(scatter, own) * rng.standard_normal(at.size)
    if exchange is not None:
        size[at >= exchange[0]] -= exchange[1]
    return at, size, np.full(at.size, own)


def test_without_scatter_the_slope_and_its_error_are_those_of_weighted_least_squares():
    at, size, own = readings(growth=0.3, scatter=0.0, own=0.5, seed=4)
    own = own * (1.0 + (at > 20))
    size = 40.0 + 0.3 * at + 0.1 * own * (-1.0) ** at  # residuals well below the errors
    found = slope(at, size, own)
    coefficients, covariance = np.polyfit(at, size, 1, w=1.0 / own, cov="unscaled")
    assert found.value == pytest.approx(coefficients[0])
    assert found.error == pytest.approx(math.sqrt(covariance[0, 0]))
    assert found.scatter == 0.0


def kept_of_the_day_before(residual):
    """Return the correlation of neighbours, by numpy's own correlation at lag 1.

    Residuals of a fitted line keep less than the days did, in the mean by (2 + 4 r) / n.
    """
    by_lag = np.correlate(residual, residual, "full")
    seen = by_lag[residual.size] / by_lag[residual.size - 1]
    return max(0.0, seen + (2.0 + 4.0 * max(0.0, seen)) / residual.size)


@pytest.mark.parametrize("seed", [1, 3, 5])  # 3: neighbours of it are none
def test_scatter_beyond_the_readings_own_errors_is_found_and_widens_the_interval(seed):
    at, size, own = readings(scatter=1.0, own=0.01, seed=seed)
    found = slope(at, size, own)
    plain = stats.linregress(at, size)  # own errors do not count: plain least squares
    residual = size - plain.intercept - plain.slope * at
    kept = kept_of_the_day_before(residual)
    assert bool(kept > 0.0) is (seed != 3)
    assert found.value == pytest.approx(plain.slope, rel=1e-3)
    assert found.correlation == pytest.approx(kept, abs=1e-3)
    longer = math.sqrt((1.0 + kept) / (1.0 - kept))
    assert found.error == pytest.approx(longer * plain.stderr, rel=1e-3)
    assert found.scatter == pytest.approx(np.std(residual, ddof=2), rel=0.01)


@pytest.mark.parametrize(
    ("lines", "least", "most"),
    [(100, 91, 99), pytest.param(200, 181, 198, marks=pytest.mark.long)],
)
def test_the_interval_holds_the_true_slope_in_about_95_of_100_lines(lines, least, most):
    hits = sum(
        found.low <= 0.05 <= found.high
        for found in (slope(*readings(growth=0.05, seed=seed)) for seed in range(lines))
    )
    assert least <= hits <= most  # 95 % of them, three standard deviations either way


def test_of_few_readings_or_of_one_place_nothing_is_said():
    at, size, own = readings(at=DAYS[: FEWEST_READINGS - 1])
    assert slope(at, size, own) is None
    assert slope(np.zeros(20), np.ones(20), np.ones(20)) is None


def drifting(seed, keeps):
    """Sizes that wander: a day keeps so much of what the day before was off."""
    rng = np.random.default_rng(seed)
    off = rng.standard_normal(DAYS.size)
    for day in range(1, off.size):
        off[day] = keeps * off[day - 1] + math.sqrt(1.0 - keeps**2) * off[day]
    return DAYS, 40.0 + off, np.full(DAYS.size, 0.1)


@FEW_AND_MANY
def test_what_days_keep_of_each_other_widens_the_interval_and_is_no_trend(lines):
    found = [slope(*drifting(seed, 0.6)) for seed in range(lines)]
    assert np.mean([line.correlation for line in found]) == pytest.approx(0.6, abs=0.1)
    assert not any(line.stands_out for line in found)
    assert sum(line.low <= 0.0 <= line.high for line in found) >= 0.85 * lines
    assert sum(jump(*drifting(seed, 0.6)) is not None for seed in range(lines // 2)) <= 1


def test_readings_without_error_or_size_are_no_division_by_zero():
    nothing = np.zeros(20)
    found = slope(np.arange(20.0), nothing, nothing)
    assert (found.value, found.stands_out) == (0.0, False)
    assert jump(np.arange(20.0), nothing, nothing) is None
    assert slope(np.arange(20.0), np.arange(20.0), nothing).value == pytest.approx(1.0)


def test_a_limit_is_reached_where_the_line_says_and_the_interval_holds_the_truth():
    hits = 0
    for seed in range(100):
        found = slope(*readings(growth=0.2, seed=seed))
        value, low, high = found.reaches(60.0)
        assert low < value < high
        assert found.at(value) == pytest.approx(60.0)
        hits += low <= 100.0 <= high  # 40 + 0.2 * 100
    assert 88 <= hits <= 100


def test_a_slope_that_may_be_none_gives_no_day():
    found = slope(*readings(growth=0.0, seed=3))
    assert not found.stands_out
    assert found.reaches(60.0)[1:] == (-math.inf, math.inf)


@pytest.mark.parametrize("day", [5.0, 20.0, 37.0])
def test_an_exchange_is_a_jump_on_its_day_with_its_size(day):
    found = jump(*readings(growth=0.2, scatter=0.5, exchange=(day, 15.0)))
    assert DAYS[found.index] == day
    assert found.before - found.after == pytest.approx(15.0, abs=2.0)


@FEW_AND_MANY
def test_a_growth_that_quickens_is_no_jump_and_nor_is_scatter(lines):
    at, size, own = readings(growth=0.2, scatter=0.5)
    assert jump(at, size + 0.01 * at**2, own) is None
    assert not any(jump(*readings(seed=seed)) for seed in range(lines))
