"""Ticks of blocks with and without a screen, and what their ratio is sure to."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
RESAMPLES = 2000


@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """Ticks of one block of time.

    Attributes
    ----------
    end_us : from the moment when a tick was due to its end, us, one per tick.
    missed : ticks that did not take place. ``idle`` : ticks in which no correction was let out.
    screen_core, supervisor_core : processor time of a process as a share of one core.
    screen_MB : resident memory at the end.
    frames_per_s, frame_bytes : of each of those who looked; NaN where nobody did.
    """

    end_us: Floats
    missed: int
    screen_core: float = 0.0
    screen_MB: float = 0.0
    supervisor_core: float = 0.0
    idle: int = 0
    frames_per_s: float = math.nan
    frame_bytes: float = math.nan


@dataclass(frozen=True, slots=True, kw_only=True)
class Ratio:
    """A quantile over another, with the 95 % interval of a bootstrap over whole blocks."""

    value: float
    low: float
    high: float

    def __str__(self) -> str:
        return f"{self.value:.2f} ({self.low:.2f} to {self.high:.2f})"


def ratio_of(of: Sequence[Block], over: Sequence[Block], quantile: float, seed: int = 1) -> Ratio:
    """Return the ratio of a quantile of two kinds of blocks.

    Ticks of one block belong together, so blocks are drawn, not ticks.

    Raises
    ------
    ValueError
        When a kind has no block.
    """
    if not of or not over:
        raise ValueError("a ratio needs blocks of both kinds")
    random = np.random.default_rng(seed)

    def drawn(blocks: Sequence[Block]) -> float:
        picked = random.integers(0, len(blocks), len(blocks))
        return _pooled([blocks[i] for i in picked], quantile)

    found = [drawn(of) / drawn(over) for _ in range(RESAMPLES)]
    low, high = np.quantile(found, [0.025, 0.975])
    value = _pooled(of, quantile) / _pooled(over, quantile)
    return Ratio(value=value, low=float(low), high=float(high))


def quantiles_us(blocks: Sequence[Block]) -> tuple[float, float, float]:
    """Return p50, p99 and p99.9 of all ticks of some blocks, us."""
    found = np.quantile(np.concatenate([b.end_us for b in blocks]), [0.5, 0.99, 0.999])
    return float(found[0]), float(found[1]), float(found[2])


def _pooled(blocks: Sequence[Block], quantile: float) -> float:
    return float(np.quantile(np.concatenate([block.end_us for block in blocks]), quantile))
