"""What reaches the guard, the record and the log from the law."""

from __future__ import annotations

import math

from aff_runtime.app.law_watch import STEADY_ASKS, HeldBlocks
from aff_runtime.core.monitor import Trend

NAMES = ("unwind.theta_rad", "unwind.unwind_1x.state", "unwind.unwind_2x.state")


def row(first: float, second: float) -> tuple[float, ...]:
    return (0.3, first, second)


def test_a_held_block_is_told_once_and_by_its_name() -> None:
    held = HeldBlocks()
    told = [held.step(NAMES, row(Trend.CLAMPED, Trend.SETTLED)) for _ in range(100)]
    assert [news for news in told if news] == [[("unwind.unwind_1x", Trend.CLAMPED)]]
    assert told[STEADY_ASKS - 1]


def test_flicker_is_not_told() -> None:
    held = HeldBlocks()
    for k in range(200):
        state = Trend.CLAMPED if k % (STEADY_ASKS - 1) else Trend.CONVERGING
        assert held.step(NAMES, row(state, Trend.CONVERGING)) == []


def test_a_block_that_was_free_in_between_is_told_again() -> None:
    held = HeldBlocks()
    count = 0
    for state in (Trend.HELD_PHASE, Trend.SETTLED, Trend.HELD_PHASE):
        for _ in range(2 * STEADY_ASKS):
            count += len(held.step(NAMES, row(Trend.SETTLED, state)))
    assert count == 2


def test_nothing_is_told_while_no_output_is_open() -> None:
    held = HeldBlocks()
    for _ in range(5 * STEADY_ASKS):
        assert held.step(NAMES, (math.nan,) * 3) == []
