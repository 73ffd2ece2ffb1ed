"""Find at how many counts a counter wraps, by what it should have counted meanwhile.

A word is read as u16 and as i16. As what it is, each step is its rate times the time that went by,
less one range where it wrapped. As what it is not, it jumps by 65536 somewhere within.
"""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise

FULL = 1 << 16  # counts of one word
_FEWEST_STEPS = 5  # changes of a counter or ramp while it is watched
_LEAST_WRAP = 8  # a step back is a wrap from so many usual steps on
_LONGEST_STEP = 4.0  # usual steps; a longer one says nothing of the rate
_PAUSE = 2.0  # usual times between two readings; a longer one is a pause
_NEIGHBOURS = 25  # readings before and after a step that say its rate
_SPREAD_SHARE = 0.95  # share of the steps that tell a rate that ``Steps.spread`` holds
_SURE_SPREADS = 2.0  # spreads by which one wrap may be off


@dataclass(frozen=True, slots=True, kw_only=True)
class Wrap:
    """Where a word wraps.

    Attributes
    ----------
    counts : after which it wraps, as measured; 65536 where it takes the whole word.
    tolerance : counts by which ``counts`` may be off; ``seen`` : how often it was seen to wrap.
    signed : whether it is an i16.
    """

    counts: float = FULL
    tolerance: float = 0.0
    seen: int = 0
    signed: bool = False

    @property
    def is_full(self) -> bool:
        """Return whether the whole word can be it."""
        return abs(self.counts - FULL) <= self.tolerance

    @property
    def wraps_after(self) -> int:
        """Return the counts after which it wraps, where that is not 65536; 0 where it is."""
        return 0 if self.is_full else round(self.counts)


NOT_SEEN = Wrap()
"""Of a word that was not seen to wrap."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Steps:
    """What a word counted from each reading to the next.

    Attributes
    ----------
    series : the readings as u16.
    expected : its rate times the time between two readings, counts.
    usual : the median of those that are not 0, with its sign.
    spread : counts within which 95 % of those that tell a rate are of what is expected.
    is_unpaused : whether neither of two readings came after a pause.
    """

    series: Sequence[int]
    expected: Sequence[float]
    usual: float
    spread: float
    is_unpaused: Sequence[bool]

    def path(self, wraps_after: int = 0, *, signed: bool = False) -> list[int]:
        """Return how far it has come at each reading; ``wraps_after`` 0: after the whole word."""
        whole = wraps_after or FULL
        steps = (
            step - whole * round((step - expected) / whole)
            for step, expected in zip(self._raw(signed=signed), self.expected, strict=True)
        )
        return list(accumulate(steps, initial=0))

    def wrap(self) -> Wrap | None:
        """Return where it wraps; None for what goes to and fro, or back by any number."""
        if self._goes_back():
            return None
        both = [self._wrap(signed=signed) for signed in (False, True)]
        folded = next((one for one in both if one.seen and not one.is_full), None)
        if folded is not None:
            return folded if self._is_regular(folded) else None
        tolerance = max(one.tolerance + abs(one.counts - FULL) for one in both)
        # a signed word that went through 0 alone jumps as u16 too, and wraps elsewhere
        return Wrap(
            tolerance=tolerance,
            seen=min(one.seen for one in both),
            signed=both[1].tolerance > both[0].tolerance,
        )

    @property
    def _least(self) -> float:
        return min(_LEAST_WRAP * abs(self.usual), FULL / 2)

    def _raw(self, *, signed: bool) -> list[int]:
        words = [signed_word(word) for word in self.series] if signed else self.series
        return [b - a for a, b in pairwise(words)]

    def _goes_back(self) -> bool:
        """Return whether a step goes back by less than a wrap."""
        sign, least = math.copysign(1.0, self.usual), self._least
        short = (_short_way(step) for step in self._raw(signed=False))
        return any(
            unpaused and sign * step < 0 and sign * (expected - step) < least
            for step, expected, unpaused in zip(
                short, self.expected, self.is_unpaused, strict=True
            )
        )

    def _jumps(self, *, signed: bool) -> list[float]:
        """Return the counts that steps are short of, where they are those of a wrap."""
        sign, least = math.copysign(1.0, self.usual), self._least
        return [
            sign * (expected - step)
            for step, expected, unpaused in zip(
                self._raw(signed=signed), self.expected, self.is_unpaused, strict=True
            )
            if unpaused and sign * (expected - step) > least
        ]

    def _wrap(self, *, signed: bool) -> Wrap:
        jumps = self._jumps(signed=signed)
        if not jumps:
            return Wrap(signed=signed)
        # not less by many wraps: at the same angle a roll turns as fast each time
        tolerance = 1.0 + _SURE_SPREADS * self.spread
        return Wrap(
            counts=statistics.median(jumps), tolerance=tolerance, seen=len(jumps), signed=signed
        )

    def _is_regular(self, wrap: Wrap) -> bool:
        jumps = self._jumps(signed=wrap.signed)
        may_be_off = 2.0 * abs(self.usual) + _SURE_SPREADS * self.spread
        return len(jumps) <= _most_wraps(len(self.expected)) and all(
            abs(jump - wrap.counts) <= may_be_off for jump in jumps
        )


def steps_of(times_s: Sequence[float], series: Sequence[int]) -> Steps | None:
    """Return a word's steps, None while they are too few; ``series`` are its readings as u16."""
    short = [_short_way(b - a) for a, b in pairwise(series)]
    nonzero = [step for step in short if step]
    if len(nonzero) < _FEWEST_STEPS or times_s[-1] <= times_s[0]:
        return None
    usual = statistics.median(nonzero)
    back = sum(step < 0 for step in nonzero) if usual > 0 else sum(step > 0 for step in nonzero)
    if not usual or back > _most_wraps(len(nonzero)):
        return None
    lasted_s = [t - s for s, t in pairwise(times_s)]
    long_s = _PAUSE * statistics.median(lasted_s)
    # a late answer may be of any time in between, so the step after it is off as well
    unpaused = [max(pair) <= long_s for pair in pairwise([0.0, *lasted_s])]
    least, most = sorted((0.0, _LONGEST_STEP * usual))
    tells_rate = [  # with no wrap of u16 or i16 in between
        ok and least <= step <= most and not (a ^ b) & 0x8000
        for ok, step, (a, b) in zip(unpaused, short, pairwise(series), strict=True)
    ]
    rates_per_s = _rates(lasted_s, short, tells_rate)
    expected = [rate * one for rate, one in zip(rates_per_s, lasted_s, strict=True)]
    distances = sorted(
        abs(a - b) for a, b, ok in zip(short, expected, tells_rate, strict=True) if ok
    )
    return Steps(
        series=series,
        expected=expected,
        usual=usual,
        spread=distances[math.floor(_SPREAD_SHARE * len(distances))] if distances else 0.0,
        is_unpaused=unpaused,
    )


def _most_wraps(steps: int) -> int:
    return max(1, steps // _LEAST_WRAP)


def _rates(
    lasted_s: Sequence[float], steps: Sequence[int], tells_rate: Sequence[bool]
) -> Sequence[float]:
    """Return the rate about each step by those near it that tell one, counts per second."""
    way, time_s = 0, 0.0
    ways, times_s = [0], [0.0]
    for step, lasted, ok in zip(steps, lasted_s, tells_rate, strict=True):
        if ok:
            way, time_s = way + step, time_s + lasted
        ways.append(way)
        times_s.append(time_s)
    mean = way / time_s if time_s > 0.0 else 0.0
    rates = []
    for number in range(len(steps)):
        begin, end = max(0, number - _NEIGHBOURS), min(len(steps), number + _NEIGHBOURS + 1)
        near_s = times_s[end] - times_s[begin]
        rates.append((ways[end] - ways[begin]) / near_s if near_s > 0.0 else mean)
    return rates


def signed_word(word: int) -> int:
    """Return a word as i16."""
    return word - FULL if word & 0x8000 else word


def way_of(series: Sequence[int]) -> list[int]:
    """Return how far a word has come at each reading, each step the short way round."""
    return list(accumulate((_short_way(b - a) for a, b in pairwise(series)), initial=0))


def _short_way(step: int) -> int:
    """Return a step between two readings the short way round: -32768 to 32767 counts."""
    return (step + FULL // 2) % FULL - FULL // 2
