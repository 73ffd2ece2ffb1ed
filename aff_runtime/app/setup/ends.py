"""After how many counts a word that counts starts over, by what it should have counted meanwhile.

A word is read as u16 and as i16. As what it is, each step is its rate times the time that went by,
less one range where it started over. As what it is not, it jumps by 65536 somewhere within.
"""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise

FULL = 1 << 16  # counts of one word
_LEAST_STEPS = 5  # changes of a counter or ramp while it is watched
_LEAST_RESTART = 8  # a step back is a restart from so many usual steps on
_EVEN = 4.0  # usual steps; a longer one says nothing of the rate
_PAUSE = 2.0  # usual times between two readings; a longer one is a pause
_NEAR = 25  # readings before and after a step that say its rate
_WITHIN = 0.95  # share of the even steps that ``Steps.spread`` holds
_SURE = 2.0  # spreads by which one restart may be off


@dataclass(frozen=True, slots=True, kw_only=True)
class End:
    """Where a word starts over.

    Attributes
    ----------
    counts : after which it starts over, as measured; 65536 where it takes the whole word.
    off : by which ``counts`` may be off; ``seen`` : how often it was seen to start over.
    signed : whether it is an i16.
    """

    counts: float = FULL
    off: float = 0.0
    seen: int = 0
    signed: bool = False

    @property
    def is_full(self) -> bool:
        """Return whether the whole word can be it."""
        return abs(self.counts - FULL) <= self.off

    @property
    def restarts_at(self) -> int:
        """Return the counts after which it starts over, where that is not 65536; 0 where it is."""
        return 0 if self.is_full else round(self.counts)


NOT_SEEN = End()
"""Of a word that was not seen to start over."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Steps:
    """What a word counted from each reading to the next.

    Attributes
    ----------
    series : the readings as u16.
    expected : its rate times the time between two readings, counts.
    usual : the median of those that are not 0, with its sign.
    spread : counts within which 95 % of the even ones are of what is expected.
    is_prompt : whether neither of two readings came after a pause.
    """

    series: Sequence[int]
    expected: Sequence[float]
    usual: float
    spread: float
    is_prompt: Sequence[bool]

    def path(self, restarts_at: int = 0, *, signed: bool = False) -> list[int]:
        """Return how far it has come at each reading; ``restarts_at`` 0: after the whole word."""
        whole = restarts_at or FULL
        steps = (
            step - whole * round((step - expected) / whole)
            for step, expected in zip(self._raw(signed=signed), self.expected, strict=True)
        )
        return list(accumulate(steps, initial=0))

    def end(self) -> End | None:
        """Return where it starts over; None for what goes to and fro, or back by any number."""
        if self._goes_back():
            return None
        both = [self._end(signed=signed) for signed in (False, True)]
        folded = next((one for one in both if one.seen and not one.is_full), None)
        if folded is not None:
            return folded if self._is_regular(folded) else None
        off = max(one.off + abs(one.counts - FULL) for one in both)
        # a signed word that went through 0 alone jumps as u16 too, and has its end elsewhere
        return End(off=off, seen=min(one.seen for one in both), signed=both[1].off > both[0].off)

    @property
    def _least(self) -> float:
        return min(_LEAST_RESTART * abs(self.usual), FULL / 2)

    def _raw(self, *, signed: bool) -> list[int]:
        words = [signed_word(word) for word in self.series] if signed else self.series
        return [b - a for a, b in pairwise(words)]

    def _goes_back(self) -> bool:
        """Return whether a step goes back by less than a restart."""
        sign, least = math.copysign(1.0, self.usual), self._least
        short = (_short_way(step) for step in self._raw(signed=False))
        return any(
            prompt and sign * step < 0 and sign * (expected - step) < least
            for step, expected, prompt in zip(short, self.expected, self.is_prompt, strict=True)
        )

    def _jumps(self, *, signed: bool) -> list[float]:
        """Return the counts that steps are short of, where they are those of a restart."""
        sign, least = math.copysign(1.0, self.usual), self._least
        return [
            sign * (expected - step)
            for step, expected, prompt in zip(
                self._raw(signed=signed), self.expected, self.is_prompt, strict=True
            )
            if prompt and sign * (expected - step) > least
        ]

    def _end(self, *, signed: bool) -> End:
        jumps = self._jumps(signed=signed)
        if not jumps:
            return End(signed=signed)
        # not less by many restarts: at the same angle a roll turns as fast each time
        off = 1.0 + _SURE * self.spread
        return End(counts=statistics.median(jumps), off=off, seen=len(jumps), signed=signed)

    def _is_regular(self, end: End) -> bool:
        jumps = self._jumps(signed=end.signed)
        may_be_off = 2.0 * abs(self.usual) + _SURE * self.spread
        return len(jumps) <= _most_restarts(len(self.expected)) and all(
            abs(jump - end.counts) <= may_be_off for jump in jumps
        )


def steps_of(times_s: Sequence[float], series: Sequence[int]) -> Steps | None:
    """Return a word's steps, None while they are too few; ``series`` are its readings as u16."""
    short = [_short_way(b - a) for a, b in pairwise(series)]
    nonzero = [step for step in short if step]
    if len(nonzero) < _LEAST_STEPS or times_s[-1] <= times_s[0]:
        return None
    usual = statistics.median(nonzero)
    back = sum(step < 0 for step in nonzero) if usual > 0 else sum(step > 0 for step in nonzero)
    if not usual or back > _most_restarts(len(nonzero)):
        return None
    lasted_s = [t - s for s, t in pairwise(times_s)]
    long_s = _PAUSE * statistics.median(lasted_s)
    # a late answer may be of any time in between, so the step after it is off as well
    prompt = [max(pair) <= long_s for pair in pairwise([0.0, *lasted_s])]
    least, most = sorted((0.0, _EVEN * usual))
    even = [  # with no end of u16 or i16 in between
        ok and least <= step <= most and not (a ^ b) & 0x8000
        for ok, step, (a, b) in zip(prompt, short, pairwise(series), strict=True)
    ]
    rates_per_s = _rates(lasted_s, short, even)
    expected = [rate * one for rate, one in zip(rates_per_s, lasted_s, strict=True)]
    far = sorted(abs(a - b) for a, b, ok in zip(short, expected, even, strict=True) if ok)
    return Steps(
        series=series,
        expected=expected,
        usual=usual,
        spread=far[math.floor(_WITHIN * len(far))] if far else 0.0,
        is_prompt=prompt,
    )


def _most_restarts(steps: int) -> int:
    return max(1, steps // _LEAST_RESTART)


def _rates(
    lasted_s: Sequence[float], steps: Sequence[int], even: Sequence[bool]
) -> Sequence[float]:
    """Return the rate about each step by the even ones near it, counts per second."""
    way, time_s = 0, 0.0
    ways, times_s = [0], [0.0]
    for step, lasted, ok in zip(steps, lasted_s, even, strict=True):
        if ok:
            way, time_s = way + step, time_s + lasted
        ways.append(way)
        times_s.append(time_s)
    mean = way / time_s if time_s > 0.0 else 0.0
    rates = []
    for number in range(len(steps)):
        begin, end = max(0, number - _NEAR), min(len(steps), number + _NEAR + 1)
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
