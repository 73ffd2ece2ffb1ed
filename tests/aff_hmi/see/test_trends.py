"""Curves over time: every tick counts, tiers agree, nothing is invented where none was known."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest

from aff_hmi.see import trends
from aff_hmi.see.series import MOST, Series, SeriesSet
from aff_hmi.see.store import Store
from aff_hmi.see.trend_part import GROUPS, WINDOW_WORDS, group_name, trend_part
from aff_hmi.see.trend_rows import (
    HOUR_S,
    LARGEST,
    LEAST,
    MEAN,
    MINUTE_S,
    SCHEMA,
    BinnedCurves,
    coarser,
    get_bins,
    joined,
    prune_trend,
    put_bins,
)
from aff_hmi.see.trends import BIN_S, FINE, MOST_POINTS, WINDOWS
from aff_hmi.words import say_in
from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.base.signals import State
from tests.aff_hmi.moments import LINE, row, seen
from tests.aff_hmi.see.trend_line import COLUMNS, LAYOUT, SAY, T0_S, Line


@pytest.fixture
def line() -> Iterator[Line]:
    found = Line(Store(None, SCHEMA))
    yield found
    found.store.close()


def test_a_second_has_least_mean_and_largest_of_every_tick(line: Line) -> None:
    line.second(88.0, 90.0, 95.0)
    line.second(89.0, math.nan, 91.0)
    found = line.tension("1min")
    assert found.t_s.tolist() == [T0_S, T0_S + 1]
    assert found.bins.tolist() == [[88.0, 91.0, 95.0], [89.0, 90.0, 91.0]]


def test_where_nothing_was_known_there_is_no_number(line: Line) -> None:
    line.second(math.nan, math.nan)
    line.second()
    line.second(90.0)
    found = line.tension("1min")
    assert found.t_s.tolist() == [T0_S, T0_S + 2]
    assert np.isnan(found.bins[0]).all()
    part = trend_part(line.of("tension", "1min"), [], SAY)
    assert part.curves[0].mean == [None, 90.0]


def test_one_bad_tick_of_an_hour_shows_in_a_year(line: Line) -> None:
    for minute in range(3):
        line.second(90.0, 250.0 if minute == 1 else 90.0)
        line.jump(59.0)
    line.jump(HOUR_S)
    line.second(90.0)
    line.jump(MINUTE_S)  # a minute of the next hour is over, and so the hour before
    line.trends._count = 0  # as after a restart: nothing is left in memory
    found = line.tension("1y")
    assert found.bins[:, LARGEST].max() == 250.0
    whole, begun = (90.0 + 170.0 + 90.0) / 3, 90.0  # an hour counts as much, however long
    assert found.bins[0, MEAN] == pytest.approx((whole + begun) / 2, rel=1e-4)
    assert found.bins[:, LEAST].min() == 90.0


def test_a_window_is_no_longer_than_it_says_and_has_few_points(line: Line) -> None:
    for _ in range(12):
        line.second(90.0)
        line.jump(70.0)
    for window, (length_s, _) in WINDOWS.items():
        assert length_s / BIN_S[window] <= MOST_POINTS
        found = line.of("tension", window)
        assert found.to_s - found.from_s == length_s
        assert len(found.binned.t_s) <= MOST_POINTS + 2
        assert found.binned.t_s[0] >= found.from_s - BIN_S[window] - MINUTE_S
        assert np.all(np.diff(found.binned.t_s) > 0)


def test_the_hour_in_which_memory_begins_is_whole_in_the_year(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Between the full hour and the begin of memory there are minutes alone."""
    monkeypatch.setattr(trends, "FINE", 90)  # seconds; an hour of them takes long to play
    line = Line(Store(None, SCHEMA))
    for second in range(300):
        line.second(250.0 if second == 10 else 90.0)
    found = line.tension("1y")
    line.store.close()
    assert found.bins[:, LARGEST].max() == 250.0


def test_a_wall_clock_that_is_put_back_leaves_curves_in_order(line: Line) -> None:
    for _ in range(5):
        line.second(90.0)
    line.at_s -= 100.0
    for _ in range(5):
        line.second(91.0)
    for window in WINDOWS:
        found = line.tension(window)
        assert np.all(np.diff(found.t_s) > 0)
        assert found.bins[-1, MEAN] == pytest.approx(91.0, abs=1.0)


def test_states_are_shares_of_each_bin(line: Line) -> None:
    line.second(90.0, 90.0, state=State.ACTIVE)
    line.second(90.0, state=State.FAULT)
    part = trend_part(line.of("tension", "1min"), [], SAY)
    assert part.active == [1.0, 0.0]
    assert part.fault == [0.0, 1.0]


def test_orders_are_kept_in_dB_while_the_correction_goes_out_and_never_else(line: Line) -> None:
    line.second(90.0)
    line.second(90.0, state=State.READY)
    part = trend_part(line.of("dB unwind", "1min"), [], SAY)
    assert [c.label for c in part.curves] == ["unwind 1x", "unwind 2x"]
    assert part.curves[0].mean == [pytest.approx(-40.0), None]
    assert part.curves[0].unit == "dB"


def test_ripple_now_and_without_are_of_the_overview(line: Line) -> None:
    line.second(90.0)
    part = trend_part(line.of("ripple", "1min"), [], SAY)
    found = {c.label: c.mean[0] for c in part.curves}
    assert found["unwind tension, of the orders, without AFF (estimate)"] == pytest.approx(
        math.sqrt((9 + 16) / 2), rel=1e-3
    )
    assert found["unwind tension, of the orders, now"] == pytest.approx(
        0.01 * math.sqrt((9 + 16) / 2), rel=1e-3
    )


def test_other_columns_keep_the_curves_that_stay(line: Line) -> None:
    line.second(90.0)
    fewer = tuple(name for name in COLUMNS if "unwind_2x" not in name)
    line.trends.look(seen(), LAYOUT, fewer)
    assert line.tension("1min").bins[0].tolist() == [90.0] * 3
    with pytest.raises(KeyError):
        line.trends.wanted("dB nobody", "1min")


def test_a_curve_that_was_not_kept_then_is_no_number() -> None:
    store = Store(None, SCHEMA)
    a, b = Series("g", "a", "value", "N"), Series("g", "b", "value", "N")
    store.put(lambda c: put_bins(c, MINUTE_S, 60, [a], np.full((3, 1), 1.0, np.float32)))
    store.put(lambda c: put_bins(c, MINUTE_S, 120, [b, a], np.full((3, 2), 2.0, np.float32)))
    found = store.now(lambda c: get_bins(c, MINUTE_S, 0, 999, [a, b]))
    store.close()
    assert found.bins[0, MEAN, 0] == 1.0
    assert np.isnan(found.bins[0, MEAN, 1])
    assert found.bins[1, MEAN].tolist() == [2.0, 2.0]


def test_longer_bins_keep_least_and_largest() -> None:
    rng = np.random.default_rng(1)
    bins = np.sort(rng.normal(size=(100, 3, 2)).astype(np.float32), axis=1)
    found = coarser(BinnedCurves(np.arange(100) * 60, bins, 60), 600)
    assert found.t_s.tolist() == list(range(0, 6000, 600))
    for n in range(10):
        part = bins[10 * n : 10 * n + 10]
        assert found.bins[n] == pytest.approx(joined(part))
        assert found.bins[n, LEAST] == pytest.approx(part[:, LEAST].min(axis=0))
        assert found.bins[n, LARGEST] == pytest.approx(part[:, LARGEST].max(axis=0))


def test_a_month_of_minutes_and_five_years_of_hours_stay_and_no_more() -> None:
    store = Store(None, SCHEMA)
    a, one = [Series("g", "a", "value", "N")], np.ones((3, 1), np.float32)
    now_s = 3e8
    for tier, ages_d in ((MINUTE_S, (29, 31)), (HOUR_S, (1829, 1831))):
        for age_d in ages_d:
            store.put(lambda c, t=tier, d=age_d: put_bins(c, t, int(now_s - d * 86_400), a, one))
    store.put(lambda c: prune_trend(c, now_s, is_full=False))
    for tier in (MINUTE_S, HOUR_S):
        assert len(store.now(lambda c, t=tier: get_bins(c, t, 0, now_s, a)).t_s) == 1
    store.put(lambda c: prune_trend(c, now_s, is_full=True))
    assert len(store.now(lambda c: get_bins(c, MINUTE_S, 0, now_s, a)).t_s) == 0
    assert len(store.now(lambda c: get_bins(c, HOUR_S, 0, now_s, a)).t_s) == 1
    store.close()


def test_size_is_bounded_by_the_number_of_curves() -> None:
    orders = {f"unwind.unwind_{n}x.{k}": 1.0 for n in range(200) for k in ("shape_mm", "state")}
    wide = SeriesSet((*COLUMNS, *orders), LAYOUT, LINE)
    assert len(wide.all) == MOST
    assert wide.of_sample(TickRow(row() | orders), {}).shape == (1, MOST)
    bytes_kept = MOST * 3 * 4 * (FINE + 30 * 24 * 60 + 5 * 366 * 24)
    assert bytes_kept < 150e6


def test_every_group_and_window_has_a_name_in_every_language(line: Line) -> None:
    assert set(WINDOW_WORDS) == set(WINDOWS) == set(BIN_S)
    groups = {one.group for one in line.trends.series} - {"state"}
    for language in ("en", "de"):
        names = [group_name(group, say_in(language)) for group in groups]
        assert all(names)
        assert len(set(names)) == len(groups)
    assert set(GROUPS) <= groups | {"let_out"}
