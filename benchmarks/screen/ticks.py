"""Ticks of blocks with and without a screen, and what their ratio is sure to."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
RESAMPLES = 2000
NEVER = 10_000  # turns: more than anybody waits for


@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """Ticks of one block of time.

    Attributes
    ----------
    end_us : from the moment when a tick was due to its end, us, one per tick.
    missed : ticks that did not take place. ``idle`` : ticks in which no correction was let out.
    idle_as : in what states those were, and by which alarm.
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
    idle_as: str = ""
    frames_per_s: float = math.nan
    frame_bytes: float = math.nan

    @property
    def idle_words(self) -> str:
        """How many ticks were idle, and why."""
        return f"{self.idle} not ACTIVE" + (f" ({self.idle_as})" if self.idle_as else "")


def as_words(idle: Mapping[str, int]) -> str:
    """Return idle ticks by what they were as one text, the most frequent first."""
    ordered = sorted(idle.items(), key=lambda one: -one[1])
    return ", ".join(f"{name} {count}" for name, count in ordered)


@dataclass(frozen=True, slots=True, kw_only=True)
class Ratio:
    """A quantile over another, with the 95 % interval of a bootstrap over whole turns."""

    value: float
    low: float
    high: float

    def __str__(self) -> str:
        return f"{self.value:.2f} ({self.low:.2f} to {self.high:.2f})"


def ratio_of(pairs: Sequence[tuple[Block, Block]], quantile: float, seed: int = 1) -> Ratio:
    """Return the ratio of a quantile of the first blocks of some pairs to that of the second.

    Ticks of one block belong together, and so do the blocks of one turn, for what the machine does
    besides lasts longer than a block: turns are drawn, no ticks.

    Raises
    ------
    ValueError
        When there is no pair.
    """
    if not pairs:
        raise ValueError("a ratio needs blocks of both kinds")
    random = np.random.default_rng(seed)

    def of(drawn: Sequence[tuple[Block, Block]]) -> float:
        return _pooled([one for one, _ in drawn], quantile) / _pooled(
            [other for _, other in drawn], quantile
        )

    found = [of([pairs[i] for i in _drawn(random, len(pairs))]) for _ in range(RESAMPLES)]
    low, high = np.quantile(found, [0.025, 0.975])
    return Ratio(value=of(pairs), low=float(low), high=float(high))


def turns_needed(ratio: Ratio, turns: int, most: float) -> int:
    """Return how many turns decide whether a ratio is at most ``most``, ``NEVER`` at most.

    An interval narrows with the root of their number about where it is now. ``turns`` itself where
    they decide it.
    """
    if not ratio.low <= most < ratio.high:
        return turns
    room = abs(most - ratio.value)
    half = ratio.high - ratio.value if ratio.value <= most else ratio.value - ratio.low
    if half > room * math.sqrt(NEVER / turns):
        return NEVER
    return math.ceil(turns * (half / room) ** 2)


def quantiles_us(blocks: Sequence[Block]) -> tuple[float, float, float]:
    """Return p50, p99 and p99.9 of all ticks of some blocks, us."""
    found = np.quantile(np.concatenate([b.end_us for b in blocks]), [0.5, 0.99, 0.999])
    return float(found[0]), float(found[1]), float(found[2])


def _drawn(random: np.random.Generator, count: int) -> list[int]:
    return [int(one) for one in random.integers(0, count, count)]


def _pooled(blocks: Sequence[Block], quantile: float) -> float:
    return float(np.quantile(np.concatenate([block.end_us for block in blocks]), quantile))
