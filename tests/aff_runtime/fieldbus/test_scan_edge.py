from __future__ import annotations

import random

import numpy as np
import pytest

from aff_runtime.fieldbus.scan_edge import MOVE_TICKS, WINDOW_TICKS, ScanEdge
from aff_runtime.loop.ticker import Ticker
from tests.doubles.virtual_clock import VirtualClock

PERIOD_NS = 5_000_000
MODULUS = 1 << 16
JITTER_NS = 200_000
MINUTE = 12_000  # ticks


def scans_read(first_ns: int, scan_ns: float, ticks: int, *, moves: bool) -> np.ndarray:
    """Return by how many scans every tick's reading is newer than the one before.

    The first scan begins at ``first_ns``; a request reaches the PLC up to 0.2 ms after its tick.
    """
    clock, dice = VirtualClock(), random.Random(5)
    ticker, edge = Ticker(clock, PERIOD_NS), ScanEdge(PERIOD_NS, MODULUS)
    read = []
    for _ in range(ticks):
        ticker.wait()
        asked_ns = clock.now_ns() + dice.randint(0, JITTER_NS)
        read.append(int((asked_ns - first_ns) // scan_ns))
        shift_ns = edge.shift_ns(read[-1] % MODULUS)
        if moves:
            ticker.shift(shift_ns)
    return np.diff(read)


def waits(steps: np.ndarray) -> np.ndarray:
    """Return the ticks from one step to the next."""
    return np.diff(np.flatnonzero(steps))


def test_a_grid_on_the_edge_of_the_scan_leaves_it_within_two_windows():
    stays, moved = (
        scans_read(JITTER_NS // 2, PERIOD_NS, 1000, moves=moves) for moves in (False, True)
    )
    assert np.mean(stays == 0) == pytest.approx(0.25, abs=0.05)  # two coins that differ
    assert (moved[WINDOW_TICKS + MOVE_TICKS :] == 1).all()


def test_half_a_scan_is_the_way_where_a_tick_sees_two_scans():
    moved = scans_read(JITTER_NS // 2, PERIOD_NS / 2, 1000, moves=True)
    assert set(moved[:WINDOW_TICKS].tolist()) == {1, 2, 3}
    assert (moved[WINDOW_TICKS + MOVE_TICKS :] == 2).all()


@pytest.mark.parametrize("scan", [2, 3])
def test_a_slower_plc_then_steps_after_as_many_ticks_every_time(scan):
    stays, moved = (
        waits(scans_read(JITTER_NS // 2, scan * PERIOD_NS, 1500, moves=moves))
        for moves in (False, True)
    )
    assert {scan - 1, scan, scan + 1} == set(stays.tolist())
    assert set(moved[(WINDOW_TICKS + MOVE_TICKS) // scan :].tolist()) == {scan}


@pytest.mark.parametrize("ppm", [-200, 200])
def test_clocks_that_drift_are_at_an_edge_in_a_third_of_the_ticks_that_they_would_be(ppm):
    """By 200 ppm an edge of 0.2 ms takes 1 s, 200 ticks; half a scan takes 12 s, 2500 ticks."""
    scan_ns = PERIOD_NS * (1.0 + 1e-6 * ppm)
    stays, moved = (
        int((scans_read(0, scan_ns, MINUTE, moves=moves) != 1).sum()) for moves in (False, True)
    )
    assert stays > 100
    assert moved < stays / 3


@pytest.mark.parametrize("scan_ns", [PERIOD_NS, 2 * PERIOD_NS, 1_700_000, 10 * PERIOD_NS])
def test_a_grid_that_is_not_on_an_edge_or_has_none_is_left_alone(scan_ns):
    edge = ScanEdge(PERIOD_NS, MODULUS)
    for tick in range(2000):
        assert edge.shift_ns(int((tick * PERIOD_NS + 1_000_000) // scan_ns)) == 0


def test_clocks_that_differ_too_much_are_not_run_after():
    """At 0.2 % an edge comes every 2.5 s, whatever is done: one move, one try, then a pause."""
    edge, moved_ns = ScanEdge(PERIOD_NS, MODULUS), 0
    dice = random.Random(5)
    for tick in range(MINUTE):
        asked_ns = tick * PERIOD_NS + moved_ns + dice.randint(0, JITTER_NS)
        moved_ns += edge.shift_ns(int(asked_ns / (1.002 * PERIOD_NS)) % MODULUS)
    assert moved_ns <= 2 * (PERIOD_NS // 2)


def test_a_heartbeat_that_starts_over_is_no_step():
    edge = ScanEdge(PERIOD_NS, 256)
    assert sum(edge.shift_ns(tick % 256) for tick in range(3000)) == 0
