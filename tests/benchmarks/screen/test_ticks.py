"""The bench of the screen: a ratio with its interval, by blocks."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.screen import ticks
from benchmarks.screen.ticks import Block, quantiles_us, ratio_of


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


def test_a_ratio_is_found_within_its_interval() -> None:
    ratio = ratio_of(blocks(150.0, 0.05, 2), blocks(100.0, 0.05, 3), 0.99)
    assert ratio.low < 1.5 < ratio.high
    assert ratio.value == pytest.approx(1.5, rel=0.1)


def test_blocks_that_differ_among_themselves_make_it_less_sure() -> None:
    calm = ratio_of(blocks(100.0, 0.01, 4), blocks(100.0, 0.01, 5), 0.99)
    rough = ratio_of(blocks(100.0, 0.40, 4), blocks(100.0, 0.40, 5), 0.99)
    assert rough.high - rough.low > 3.0 * (calm.high - calm.low)


def test_a_ratio_of_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="both kinds"):
        ratio_of([], blocks(1.0, 0.0, 1), 0.99)
