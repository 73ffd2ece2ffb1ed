"""Curves over time when the screen ends and comes back: nothing counts twice, nothing is lost."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from aff_hmi.see.series import Series
from aff_hmi.see.store import Store
from aff_hmi.see.trend_part import trend_part
from aff_hmi.see.trend_rows import HOUR_S, LARGEST, MEAN, SCHEMA, BinnedCurves, get_bins
from aff_hmi.see.trends import Trends
from tests.aff_hmi.moments import seen
from tests.aff_hmi.see.trend_line import LAYOUT, SAY, T0_S, Line


def test_what_is_in_memory_and_what_was_stored_follow_each_other_without_overlap(
    tmp_path: Path,
) -> None:
    line = Line(Store(tmp_path, SCHEMA))
    for _ in range(30):
        line.second(90.0)
        line.jump(9.0)
    line.trends.flush()
    line.store.close()
    again = Line(Store(tmp_path, SCHEMA), line.at_s + 30.0)
    for _ in range(20):
        again.second(91.0)
        again.jump(4.0)
    found = again.tension("1h")
    assert np.all(np.diff(found.t_s) > 0)
    means = found.bins[:, MEAN]
    assert means[0] == 90.0
    assert means[-1] == 91.0
    assert found.t_s[0] == T0_S
    again.store.close()


def hours(store: Store) -> BinnedCurves:
    """Return the rows of the year view as they are kept, of the tension alone."""
    curve = Series("tension", "unwind tension", "value", "N")
    found = store.now(lambda c: get_bins(c, HOUR_S, 0, 2 * T0_S, [curve]))
    return BinnedCurves(found.t_s, found.bins[:, :, 0], HOUR_S)


@pytest.mark.parametrize("is_crash", [False, True])
def test_the_hour_in_which_the_screen_ended_is_in_the_year(tmp_path: Path, is_crash: bool) -> None:
    """Two minutes at 88 N and one at 97 N: 91 N of the hour, whenever the screen is back."""
    line = Line(Store(tmp_path, SCHEMA))
    for tension in (88.0, 88.0, 97.0):
        line.second(tension)
        line.jump(59.0)
    if not is_crash:
        line.trends.flush()
    line.store.close()
    again = Line(Store(tmp_path, SCHEMA), T0_S + 30 * HOUR_S)
    found = hours(again.store)
    assert found.t_s.tolist() == [T0_S]
    assert found.bins[0].tolist() == [88.0, 91.0, 97.0]
    assert again.tension("1y").bins[0].tolist() == [88.0, 91.0, 97.0]
    again.store.close()


def test_an_hour_that_goes_on_after_a_stop_is_whole_though_the_screen_then_crashes(
    tmp_path: Path,
) -> None:
    at_s = T0_S
    for tension in (80.0, 90.0, 100.0):
        line = Line(Store(tmp_path, SCHEMA), at_s)
        line.second(tension)
        line.jump(59.0)
        at_s = line.at_s + 120.0
        if tension == 80.0:
            line.trends.flush()
        line.store.close()
    last = Line(Store(tmp_path, SCHEMA), at_s)
    assert hours(last.store).bins.tolist() == [[80.0, 90.0, 100.0]]
    last.store.close()


def test_a_restart_within_a_minute_adds_to_its_row(tmp_path: Path) -> None:
    """20 s at 90 N, a restart, 10 s at 96 N: a mean of (20 * 90 + 10 * 96) / 30 = 92 N."""
    at_s = T0_S
    for count, tension in ((15, 90.0), (5, 90.0), (10, 96.0)):
        line = Line(Store(tmp_path, SCHEMA), at_s)
        for _ in range(count):
            line.second(tension)
        line.trends.flush()
        line.store.close()
        at_s = line.at_s + 5.0
    last = Line(Store(tmp_path, SCHEMA), T0_S + 2 * HOUR_S)
    assert last.tension("8h").bins[0].tolist() == [90.0, pytest.approx(92.0), 96.0]
    assert hours(last.store).bins[0].tolist() == [90.0, pytest.approx(92.0), 96.0]
    last.store.close()


def test_what_was_not_known_before_a_restart_does_not_count(tmp_path: Path) -> None:
    at_s = T0_S
    for tension in (math.nan, 96.0):
        line = Line(Store(tmp_path, SCHEMA), at_s)
        for _ in range(10):
            line.second(tension)
        line.trends.flush()
        line.store.close()
        at_s = line.at_s + 5.0
    last = Line(Store(tmp_path, SCHEMA), T0_S + 2 * HOUR_S)
    assert last.tension("8h").bins[0].tolist() == [96.0] * 3
    last.store.close()


def test_a_screen_that_saw_no_line_leaves_what_is_kept_as_it_is(tmp_path: Path) -> None:
    line = Line(Store(tmp_path, SCHEMA))
    line.second(90.0)
    line.trends.flush()
    line.store.close()
    blind = Store(tmp_path, SCHEMA)
    trends = Trends(blind, lambda: T0_S + 30.0)
    trends.look(replace(seen(), writer_lives=False), LAYOUT, ())
    trends.flush()
    assert hours(blind).bins.tolist() == [[90.0, 90.0, 90.0]]
    blind.close()


def test_a_gap_while_the_screen_was_off_stays_a_gap(tmp_path: Path) -> None:
    line = Line(Store(tmp_path, SCHEMA))
    for wait_s in (0.0, 60.0, 7200.0, 60.0):
        line.second(90.0)
        line.jump(wait_s)
    found = line.tension("8h")
    assert not np.any((found.t_s > T0_S + 240) & (found.t_s < T0_S + 7200))
    # what the chart makes of it: test_bins_script.py
    part = trend_part(line.of("tension", "8h"), [], SAY)
    far = np.diff(part.t_s) > 1.5 * np.array(part.wide_s[:-1])
    assert far.sum() == 1
    assert part.t_s[int(far.argmax())] < T0_S + 240
    line.store.close()


def test_a_stored_minute_in_a_finer_window_is_of_a_minute(tmp_path: Path) -> None:
    """Three minutes that were kept, a restart, and seconds of memory: 12 s each in an hour."""
    line = Line(Store(tmp_path, SCHEMA))
    for _ in range(3):
        line.second(90.0)
        line.jump(59.0)
    line.store.close()
    again = Line(Store(tmp_path, SCHEMA), line.at_s + 30.0)
    for _ in range(24):
        again.second(91.0)
    part = trend_part(again.of("tension", "1h"), [], SAY)
    again.store.close()
    assert part.t_s == [T0_S, T0_S + 60, T0_S + 120, T0_S + 204, T0_S + 216, T0_S + 228]
    assert part.wide_s == [60, 60, 60, 12, 12, 12]
    assert part.bin_s == 12


@pytest.mark.parametrize("passed_s", [0.0, 1800.0, 4200.0])
def test_the_begun_hour_is_in_the_year_after_a_restart(tmp_path: Path, passed_s: float) -> None:
    """Spike of 250 N at 10:05, restart at 10:50: it is in the year then, and later."""
    line = Line(Store(tmp_path, SCHEMA))
    for minute in range(50):
        line.second(250.0 if minute == 5 else 90.0)
        line.jump(59.0)
    line.trends.flush()
    line.store.close()
    again = Line(Store(tmp_path, SCHEMA), line.at_s)
    for _ in range(1 + round(passed_s / 60)):
        again.second(90.0)
        again.jump(59.0)
    found = again.tension("1y")
    again.store.close()
    assert found.bins[:, LARGEST].max() == 250.0
    assert found.t_s.tolist() == [T0_S // 108_000 * 108_000]


def test_stored_and_new_minutes_of_one_bin_are_one_point(tmp_path: Path) -> None:
    line = Line(Store(tmp_path, SCHEMA))
    for tension in (90.0, 90.0, 90.0):
        line.second(tension)
        line.jump(59.0)
    line.store.now(lambda c: None)
    line.trends._count = 0  # as after a restart
    line.second(94.0)
    for window in ("7d", "1y", "8h"):
        found = line.tension(window)
        assert np.all(np.diff(found.t_s) > 0)
    assert line.tension("7d").bins[0].tolist() == [90.0, 91.0, 94.0]
    line.store.close()
