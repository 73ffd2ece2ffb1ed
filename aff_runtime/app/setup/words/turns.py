"""Counts in a turn of a roll, over whole turns of it: an estimate and its interval."""

from __future__ import annotations

import math
import statistics
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise

AGREED = 0.014
"""Share by which line speed over radius may be off: 1 % each, as step 2 of the card asks."""
UNSEEN = 0.05
"""The same before one whole turn was seen: a roll that is not round turns unevenly."""
_SURE = 2.0  # standard deviations of the scatter that make half of the interval


@dataclass(frozen=True, slots=True, kw_only=True)
class CountsPerTurn:
    """What was measured.

    Attributes
    ----------
    counts : in a turn of the roll, negative against the web.
    off : half of the interval, as a share of ``counts``.
    turns : of the roll that were seen, by line speed and radius.
    """

    counts: float
    off: float
    turns: float

    @property
    def low(self) -> float:
        """Return the low end of the interval, without the sign."""
        return abs(self.counts) * (1.0 - self.off)

    @property
    def high(self) -> float:
        """Return the high end of the interval, without the sign."""
        return abs(self.counts) * (1.0 + self.off)

    def holds(self, counts: float) -> bool:
        """Return whether the interval holds a number of counts; its sign does not matter."""
        return self.low <= abs(counts) <= self.high


def counts_per_turn(
    times_s: Sequence[float], path: Sequence[float], speeds_m_s: Sequence[float], radius_m: float
) -> CountsPerTurn | None:
    """Return what a count says of a turn; None while no web moves.

    A roll that is not round turns unevenly within a turn, and by its mean radius over whole ones.
    So counts are taken over the web of whole turns, two thirds of those that were seen, beginning
    at every reading that has so many after it.

    Parameters
    ----------
    path : how far the count has come, wraps taken out.
    speeds_m_s : of the web, as many as ``times_s``.
    radius_m : of the roll, above 0.
    """
    web_m = list(
        accumulate(
            (
                0.5 * (v + w) * (t - s)
                for (s, t), (v, w) in zip(pairwise(times_s), pairwise(speeds_m_s), strict=True)
            ),
            initial=0.0,
        )
    )
    turn_m = 2.0 * math.pi * radius_m
    turns = abs(web_m[-1]) / turn_m
    if not turns:
        return None
    if web_m[-1] < 0.0:
        web_m = [-one for one in web_m]
    if turns < 1.0:
        return CountsPerTurn(counts=(path[-1] - path[0]) / turns, off=UNSEEN, turns=turns)
    whole = max(1, math.floor(2.0 * turns / 3.0))
    each = [
        (_at(web_m, path, begin + whole * turn_m) - count) / whole
        for begin, count in zip(web_m, path, strict=True)
        if begin + whole * turn_m <= web_m[-1]
    ]
    counts = statistics.fmean(each)
    scatter = _SURE * statistics.pstdev(each) / abs(counts) if counts else 0.0
    return CountsPerTurn(counts=counts, off=math.hypot(AGREED, scatter), turns=turns)


def _at(web_m: Sequence[float], path: Sequence[float], place_m: float) -> float:
    """Return the count when so much web had passed; a straight line between two readings."""
    after = min(max(1, bisect_left(web_m, place_m)), len(web_m) - 1)
    before = after - 1
    way_m = web_m[after] - web_m[before]
    share = (place_m - web_m[before]) / way_m if way_m > 0.0 else 0.0
    return path[before] + share * (path[after] - path[before])
