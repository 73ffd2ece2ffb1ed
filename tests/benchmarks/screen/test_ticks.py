"""The bench of the screen: a ratio with its interval, by blocks."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.screen import ticks
from benchmarks.screen.ticks import (
    NEVER,
    Block,
    Ratio,
    as_words,
    quantiles_us,
    ratio_of,
    turns_needed,
)


def blocks(scale: float, spread: float, seed: int, count: int = 12) -> list[Block]:
    """Return blocks whose ticks are exponential, each block with a level of its own."""
    random = np.random.default_rng(seed)
    levels = scale * np.exp(spread * random.standard_normal(count))
    return [Block(end_us=random.exponential(level, 2000), missed=0) for level in levels]


@pytest.fixture(autouse=True)
def _few_resamples(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ticks, "RESAMPLES", 300)


def test_the_quantiles_are_those_of_all_ticks() -> None:
    p50, p99, _ = quantiles_us(blocks(100.0, 0.0, 1))
    assert p50 == pytest.approx(100.0 * np.log(2.0), rel=0.05)
    assert p99 == pytest.approx(100.0 * np.log(100.0), rel=0.05)


def pairs(of: list[Block], over: list[Block]) -> list[tuple[Block, Block]]:
    return list(zip(of, over, strict=True))


def test_a_ratio_is_found_within_its_interval() -> None:
    ratio = ratio_of(pairs(blocks(150.0, 0.05, 2), blocks(100.0, 0.05, 3)), 0.99)
    assert ratio.low < 1.5 < ratio.high
    assert ratio.value == pytest.approx(1.5, rel=0.1)


def test_blocks_that_differ_among_themselves_make_it_less_sure() -> None:
    calm = ratio_of(pairs(blocks(100.0, 0.01, 4), blocks(100.0, 0.01, 5)), 0.99)
    rough = ratio_of(pairs(blocks(100.0, 0.40, 4), blocks(100.0, 0.40, 5)), 0.99)
    assert rough.high - rough.low > 3.0 * (calm.high - calm.low)


def test_what_meets_both_blocks_of_a_turn_makes_it_no_less_sure() -> None:
    same = ratio_of(pairs(blocks(150.0, 0.40, 4), blocks(100.0, 0.40, 4)), 0.99)
    other = ratio_of(pairs(blocks(150.0, 0.40, 4), blocks(100.0, 0.40, 5)), 0.99)
    assert same.value == pytest.approx(1.5)
    assert same.high - same.low < 0.1 * (other.high - other.low)


def test_a_ratio_of_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="both kinds"):
        ratio_of([], 0.99)


@pytest.mark.parametrize(
    ("ratio", "needed"),
    [
        (Ratio(value=1.01, low=0.86, high=1.10), 41),  # 8 (0.09 / 0.04)^2 = 40.5
        (Ratio(value=1.09, low=1.04, high=1.16), 13),  # 8 (0.05 / 0.04)^2 = 12.5
        (Ratio(value=1.00, low=0.90, high=1.05), 8),  # met
        (Ratio(value=1.20, low=1.10, high=1.30), 8),  # missed
        (Ratio(value=1.05, low=1.00, high=1.10), NEVER),
    ],
)
def test_how_many_turns_decide_is_told_by_the_interval(ratio: Ratio, needed: int) -> None:
    assert turns_needed(ratio, 8, 1.05) == needed


def test_what_an_idle_tick_was_is_told() -> None:
    said = as_words({"FADING": 3, "FAULT by PLC_STALE": 40})
    assert said == "FAULT by PLC_STALE 40, FADING 3"
    assert Block(end_us=np.zeros(0), missed=0, idle=43, idle_as=said).idle_words == (
        "43 not ACTIVE (FAULT by PLC_STALE 40, FADING 3)"
    )
