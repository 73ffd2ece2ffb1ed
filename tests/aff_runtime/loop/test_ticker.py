from __future__ import annotations

from itertools import pairwise

from aff_runtime.loop.ticker import Ticker
from tests.doubles.virtual_clock import VirtualClock

MS = 1_000_000


def test_deadlines_are_absolute_whatever_the_work_takes() -> None:
    clock = VirtualClock(7 * MS)
    ticker = Ticker(clock, 5 * MS)
    starts = []
    for work_ms in (1, 4, 0, 3, 2):
        assert ticker.wait() == 1
        starts.append(clock.now_ns() // MS)
        clock.advance_ns(work_ms * MS)
    assert starts == [12, 17, 22, 27, 32]
    assert ticker.missed == 0


def test_after_a_stall_missed_ticks_are_skipped_and_counted_without_a_burst() -> None:
    clock = VirtualClock()
    ticker = Ticker(clock, 10 * MS)
    ticker.wait()
    clock.advance_ns(64 * MS)  # from 10 to 74 ms
    seen = []
    for _ in range(4):
        seen.append((ticker.wait(), clock.now_ns() // MS))
    assert seen == [(6, 74), (1, 80), (1, 90), (1, 100)]
    assert ticker.missed == 5


def test_a_tick_more_than_half_a_period_late_waits_for_the_next_grid_point() -> None:
    clock = VirtualClock()
    ticker = Ticker(clock, 10 * MS)
    ticker.wait()
    clock.advance_ns(17 * MS)  # to 27 ms: 7 ms after the grid point
    assert ticker.wait() == 2
    assert clock.now_ns() == 30 * MS
    assert ticker.late


def test_periods_add_up_to_the_grid_however_late_the_ticks_come() -> None:
    clock = VirtualClock()
    ticker = Ticker(clock, 5 * MS)
    total = 0
    last_start_ns = -5 * MS
    for work_ns in range(0, 40 * MS, 777_777):
        total += ticker.wait()
        assert ticker.deadline_ns == total * 5 * MS
        assert clock.now_ns() - last_start_ns >= 5 * MS // 2
        last_start_ns = clock.now_ns()
        clock.advance_ns(work_ns)


def test_lateness_and_overrun_are_told() -> None:
    clock = VirtualClock()
    ticker = Ticker(clock, 5 * MS)
    ticker.wait()
    assert (ticker.late, ticker.wake_ns) == (False, 0)
    clock.advance_ns(6 * MS)
    assert ticker.wait() == 1
    assert (ticker.late, ticker.wake_ns) == (True, 1 * MS)


def test_time_before_the_start_does_not_count() -> None:
    clock = VirtualClock()
    ticker = Ticker(clock, 5 * MS)
    clock.advance_ns(900 * MS)
    ticker.start()
    assert ticker.wait() == 1
    assert ticker.missed == 0


def test_the_grid_moves_by_half_a_percent_of_a_period_at_most() -> None:
    clock = VirtualClock()
    ticker = Ticker(clock, 5 * MS)
    starts = []
    for wanted_ns in (10_000, 10 * MS, -10 * MS, 0):
        assert ticker.wait() == 1
        starts.append(clock.now_ns())
        ticker.shift(wanted_ns)
    steps = [after - before for before, after in pairwise(starts)]
    assert steps == [5_010_000, 5_025_000, 4_975_000]
    assert (ticker.missed, ticker.late) == (0, False)
