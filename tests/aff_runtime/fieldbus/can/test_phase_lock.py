from __future__ import annotations

import random

import pytest

from aff_runtime.fieldbus.can.phase_lock import PhaseLock
from aff_runtime.loop.ticker import Ticker
from tests.doubles.virtual_clock import VirtualClock

PERIOD_NS = 5_000_000
MARGIN_NS = 1_000_000


def leads_ns(first_ns: int, scan_ns: int, jitter_ns: int = 0, ticks: int = 2000) -> list[int]:
    """Time from the newest scan's arrival to each tick, by a loop of lock and ticker."""
    clock, dice = VirtualClock(), random.Random(5)
    ticker, lock = Ticker(clock, PERIOD_NS), PhaseLock(PERIOD_NS, MARGIN_NS)
    seen, arrivals = [], [first_ns]
    while arrivals[-1] < (ticks + 2) * PERIOD_NS:
        arrivals.append(first_ns + len(arrivals) * scan_ns + dice.randint(0, jitter_ns))
    for _ in range(ticks):
        ticker.wait()
        newest = max((at for at in arrivals if at <= clock.now_ns()), default=None)
        arrivals = [at for at in arrivals if at > clock.now_ns()]
        if newest is not None:
            seen.append(clock.now_ns() - newest)
            ticker.shift(lock.shift_ns(seen[-1]))
    return seen


@pytest.mark.parametrize("first_ns", range(0, 5_000_000, 625_000))
@pytest.mark.sweep(every=3)
def test_from_any_phase_the_ticks_settle_at_the_margin_behind_the_arrival(first_ns: int) -> None:
    assert leads_ns(first_ns, PERIOD_NS)[-1] == pytest.approx(MARGIN_NS, abs=20)


@pytest.mark.parametrize("drift_ns", [-2000, 2000])
def test_a_plc_whose_clock_runs_off_is_followed_without_a_slip(drift_ns: int) -> None:
    leads = leads_ns(3_000_000, PERIOD_NS + drift_ns)
    assert len(leads) == pytest.approx(2000, abs=2)
    # a steady drift is followed with sixteen times the drift of a tick
    assert leads[-1] == pytest.approx(MARGIN_NS - 16 * drift_ns, abs=40)


def test_jitter_of_the_arrivals_reaches_the_ticks_in_small_part_only() -> None:
    leads = leads_ns(3_000_000, PERIOD_NS, jitter_ns=600_000)
    assert max(leads[500:]) < MARGIN_NS + 600_000
    assert min(leads[500:]) > 0  # no tick without a scan


def test_scans_of_another_rate_are_lived_with() -> None:
    leads = leads_ns(0, 7_000_000)
    assert max(leads) <= 7_000_000


def test_the_shift_is_the_share_of_the_error_across_the_end_of_the_period() -> None:
    lock = PhaseLock(PERIOD_NS, MARGIN_NS)
    assert lock.shift_ns(MARGIN_NS) == 0
    assert lock.shift_ns(MARGIN_NS + 1600) == -100
    assert lock.shift_ns(PERIOD_NS - 600_000) == 100_000  # 1.6 ms short of the margin
