"""The main job in virtual time: ripple by order before and after, as the web really has it."""

from __future__ import annotations

import numpy as np
import pytest

from aff_runtime.loop.messages import Arm
from sim_plant.base.order_tracking import order_amplitudes, reduction_dB
from tests.lockstep.bench import Bench, Setup
from tests.lockstep.fault_table import assert_never_above_limit
from tests.lockstep.silent import SKIPPED_S, silent_rows, watched

UNWIND_ORDERS = (1, 2, 3, 4)
ARMED_S, JUDGED_S = 30.0, 25.0
SHORTLY_S, SHORTLY_JUDGED_S = 10.0, 5.0
NOISE_FLOOR_N = 3.0 * 0.25 * (2.0 * 0.005 / JUDGED_S) ** 0.5  # 3 sigma of an order, 0.25 N cell


def _ripple(rows: list[tuple[float, ...]]) -> tuple[np.ndarray, float]:
    """Return |ripple| of the unwind orders in its tension and of the follower's first, N."""
    unwind_N, pullroll_N, unwind_rad, follower_rad = np.array(rows).T
    unwind = order_amplitudes(unwind_N, unwind_rad, UNWIND_ORDERS, {"f": follower_rad})
    follower = order_amplitudes(pullroll_N, follower_rad, (1,), {"u": unwind_rad})
    return np.abs(unwind), float(abs(follower[0]))


def _outcome(responses, armed_s: float, judged_s: float):
    """Return ripple before and after some time armed at 200 FPM, with the shipped files."""
    bench = Bench(Setup(responses=responses, soft_start_s=1.5))
    seen = watched(bench)
    bench.run(SKIPPED_S)
    bench.arm(armed_s)
    seen.clear()
    bench.run(judged_s)
    after = _ripple(seen)
    assert_never_above_limit(bench.applied)
    return _ripple(silent_rows()), after


@pytest.fixture(scope="module")
def shortly(responses):
    """Two settle times of the unwind's blocks, and four turns to judge it."""
    return _outcome(responses, 1.5 + SHORTLY_S, SHORTLY_JUDGED_S)


@pytest.fixture(scope="module")
def outcome(responses):
    return _outcome(responses, ARMED_S, JUDGED_S)


def test_a_runtime_that_is_not_armed_changes_no_bit_of_the_line(responses):
    bench = Bench(Setup(responses=responses))
    seen = watched(bench)
    bench.run(SKIPPED_S)
    seen.clear()
    bench.run(1.0)
    assert seen == silent_rows()[: len(seen)]


def test_the_line_ripples_before(shortly):
    (unwind_N, follower_N), _ = shortly
    assert np.all(unwind_N > 0.3)
    assert follower_N > 0.3


def test_shortly_after_arming_every_order_is_at_a_third(shortly):
    (before_N, follower_before_N), (after_N, follower_N) = shortly
    assert np.all(after_N < before_N / 3.0)
    assert follower_N < follower_before_N / 3.0


@pytest.mark.long  # quick: at a third, above
def test_unwind_orders_fall_by_30_dB_or_to_the_noise(outcome):
    (before_N, _), (after_N, _) = outcome
    for order, b, a in zip(UNWIND_ORDERS, before_N, after_N, strict=True):
        assert reduction_dB(b, a) >= 30.0 or a < NOISE_FLOOR_N, f"{order}x: {b:.3f} -> {a:.4f} N"


@pytest.mark.long
def test_the_followers_first_order_falls_by_20_dB_in_pull_roll_tension(outcome):
    (_, before_N), (_, after_N) = outcome
    assert reduction_dB(before_N, after_N) >= 20.0


def test_without_a_measured_response_nothing_arms():
    bench = Bench(Setup())
    bench.run(0.5)
    bench.say(Arm())
    bench.run(1.0)
    assert "response" in bench.outside.blocked_by
    assert max(bench.plant.max_abs_applied_m_s.values()) == 0.0
