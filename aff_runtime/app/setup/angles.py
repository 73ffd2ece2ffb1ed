"""Which words are a roll's angle: counts in a turn by line speed and radius, and their wrap."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from aff_runtime.app.setup.behaviour import Behaviour, Kind, behaviours, is_signed, way_of
from aff_runtime.app.setup.decoding import HIGH_FIRST, LOW_FIRST, Decoding
from aff_runtime.app.setup.reading import Watched
from aff_runtime.app.setup.turns import CountsPerTurn, counts_per_turn
from aff_runtime.base.units import plain

USUAL_COUNTS = tuple(
    sorted(
        {2**power for power in range(6, 25)}
        | {factor * lines for lines in (
            100, 180, 200, 250, 300, 360, 400, 500, 600, 720, 800, 900, 1000, 1024, 1200, 1250,
            1440, 1500, 1800, 2000, 2048, 2500, 3000, 3600, 4000, 4096, 5000, 7200, 8192, 9000,
            10000) for factor in (1, 4)}
        | {20000, 36000, 100000, 131072, 360000, 1000000}
    )
)  # fmt: skip
"""Counts per turn of encoders: powers of two, lines once and four times, some round numbers."""
FAR = 0.05
"""Usual numbers within this share of the measured one are shown too: a technician may take one."""
LONGEST_S = 45.0  # for which words are watched, at most
_FULL = 1 << 16  # counts of one word
_ALONE = 8.0
"""What a candidate loses of its score when it leaves no word for another roll; a carry adds 6."""
_OFF = 0.01
"""Share of the measured counts; a number that is so far off loses half a point of the score."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AngleCandidate:
    """One reading of words as an angle.

    Attributes
    ----------
    counts_per_turn : a usual number; negative when it counts against the web.
    measured : what the count, line speed and radius say over whole turns, with its interval.
    low_word : wire address of the word that moves.
    why : reasons for and against. ``score`` : without unit; the higher, the likelier.
    wraps_after : counts after which it starts over, where that is not all that its words hold; 0
        where it is. ``usable`` : False for a count that starts over after no whole turns.
    leaves_none : another roll that no other word can be then; empty where there is none.
    """

    decoding: Decoding
    counts_per_turn: int
    measured: CountsPerTurn
    low_word: int
    why: tuple[str, ...]
    score: float
    usable: bool = True
    wraps_after: int = 0
    leaves_none: str = ""

    @property
    def scale_text(self) -> str:
        """Return the scale as the site file writes it."""
        return f"{self.counts_per_turn} counts/turn"

    @property
    def is_held(self) -> bool:
        """Return whether the interval holds this number."""
        return self.measured.holds(self.counts_per_turn)

    def without(self, roll: str) -> AngleCandidate:
        """Return it as one that leaves no word for another roll."""
        why = (*self.why, f"then no word is left that can be {roll}")
        return replace(self, leaves_none=roll, why=why, score=self.score - _ALONE)


def angle_candidates(
    seen: Watched,
    *,
    speeds_m_s: Sequence[float],
    radius_m: float,
    taken: frozenset[int] = frozenset(),
    word_order: str = "",
    does: Mapping[int, Behaviour] | None = None,
) -> list[AngleCandidate]:
    """Return the words that can be the angle of a roll, best first.

    Parameters
    ----------
    speeds_m_s : of the web at each reading; ``radius_m`` : of the roll, above 0.
    word_order : order of two words of the PLC where it is known.
    does : the words' behaviours, where they are known.
    """
    candidates = []
    for address, did in (does or behaviours(seen)).items():
        if address in taken or did.kind not in (Kind.COUNTER, Kind.RAMP):
            continue
        path = way_of(seen.words[address], did.restarts_at)
        measured = counts_per_turn(seen.times_s, path, speeds_m_s, radius_m)
        if measured is None:
            continue
        for counts in _usual(measured):
            signed = round(math.copysign(counts, measured.counts))
            off = abs(counts / abs(measured.counts) - 1.0)
            wraps_after = _whole_turns(did, seen, counts)
            rows = (
                _starting_over(address, did, seen, wraps_after)
                if did.restarts_at
                else _decodings(address, did, seen, taken, word_order)
            )
            for decoding, score, why in rows:
                candidates.append(
                    AngleCandidate(
                        decoding=decoding,
                        counts_per_turn=signed,
                        measured=measured,
                        low_word=address,
                        why=(*_said(measured, counts), *why),
                        score=score + _usualness(counts) - 0.5 * (off / _OFF) ** 2,
                        usable=not did.restarts_at or wraps_after > 0,
                        wraps_after=wraps_after,
                    )
                )
    return _sorted(candidates)


def beside(
    rows: Sequence[AngleCandidate], other: Sequence[AngleCandidate], roll: str
) -> list[AngleCandidate]:
    """Return candidates of one roll; those that leave no word for ``roll`` come last.

    Two rollers that are nearly as large can each be read as the other one, with another usual
    number of counts; both together often cannot.

    Parameters
    ----------
    other : candidates of ``roll`` among the same words.
    """
    free = {one.low_word for one in other if one.is_held and one.usable}
    if not any(one.is_held and free - {one.low_word} for one in rows):
        return list(rows)  # ``roll`` may have no encoder
    return _sorted([one if free - {one.low_word} else one.without(roll) for one in rows])


def is_sure(rows: Sequence[AngleCandidate]) -> bool:
    """Return whether the best row stands alone: no other word and no other number can be it."""
    can_be = {
        (one.low_word, one.counts_per_turn) for one in rows if one.is_held and not one.leaves_none
    }
    return len(can_be) == 1 and (rows[0].low_word, rows[0].counts_per_turn) in can_be


def _sorted(rows: Iterable[AngleCandidate]) -> list[AngleCandidate]:
    return sorted(rows, key=lambda one: -one.score)


def _said(measured: CountsPerTurn, counts: int) -> tuple[str, ...]:
    numbers = (
        plain(float(f"{one:.5g}")) for one in (abs(measured.counts), measured.low, measured.high)
    )
    said = "measured {} counts/turn ({} to {})".format(*numbers)
    if measured.turns < 1.0:
        return (said, "in less than one turn")
    if not measured.holds(counts):
        return (said, "not this number if radius and line speed are right")
    return (said,)


def _usual(measured: CountsPerTurn) -> list[int]:
    """Return the usual numbers near a measured one, three at most, the nearest first."""
    size = abs(measured.counts)
    near = [one for one in USUAL_COUNTS if measured.holds(one) or abs(one - size) < FAR * size]
    return sorted(near, key=lambda one: abs(one - size))[:3]


def _usualness(counts: int) -> float:
    """Return what a power of two, or a multiple of 1000, adds to the score."""
    return 0.7 if counts & (counts - 1) == 0 or counts % 1000 == 0 else 0.0


def _whole_turns(does: Behaviour, seen: Watched, counts: int) -> int:
    """Return after how many counts a word starts over, as whole turns; 0 where it is none.

    What was seen of its end is off by what it counts from one reading to the next.
    """
    period_s = (seen.times_s[-1] - seen.times_s[0]) / (len(seen.times_s) - 1)
    turns = round(does.restarts_at / counts)
    off = abs(does.restarts_at - turns * counts)
    return turns * counts if off <= 2.0 * abs(does.rate_per_s) * period_s + 1.0 else 0


def _starting_over(
    address: int, does: Behaviour, seen: Watched, wraps_after: int
) -> list[tuple[Decoding, float, tuple[str, ...]]]:
    """Return how a count is stored that starts over within its word, its score, and why."""
    word = "i16" if is_signed(seen.words[address], does.restarts_at) else "u16"
    decoding = Decoding(address=address, type=word)
    if wraps_after:
        return [(decoding, 4.0, (f"starts over after {wraps_after}",))]
    why = f"starts over at {does.restarts_at}, which is no whole turns. Let the PLC count on"
    return [(decoding, -5.0, (why,))]


def _decodings(
    address: int, does: Behaviour, seen: Watched, taken: frozenset[int], word_order: str
) -> list[tuple[Decoding, float, tuple[str, ...]]]:
    """Return how the count may be stored (one word, or two with the carry), its score, and why."""
    rows: list[tuple[Decoding, float, tuple[str, ...]]] = []
    carries: Mapping[str, int] = {HIGH_FIRST: address - 1, LOW_FIRST: address + 1}
    proved = False
    for name, high in carries.items():
        if high not in seen.words or high in taken:
            continue
        carry = _carries(seen.words[address], seen.words[high])
        if carry is None:
            continue
        first = min(address, high)
        decoding = Decoding(address=first, type="i32", order=name)
        proved = proved or carry
        score = 6.0 if carry else (0.5 if name == word_order else -1.0 if word_order else -0.5)
        why = (f"word {high} takes its carry",) if carry else (f"no carry into {high} seen yet",)
        rows.append((decoding, score, why))
    wrapped = does.wraps > 0
    one = "wraps at 65536" if wrapped and not proved else "its low word" if proved else "one word"
    score = -2.0 if proved else 2.0 if wrapped else 0.0
    rows.append((Decoding(address=address, type="u16"), score, (one,)))
    return rows


def _carries(low: Sequence[int], high: Sequence[int]) -> bool | None:
    """Return whether the high word takes the carry of the low one.

    True when it steps with every wrap and at no other time, None when it does not; False while
    there was no wrap.
    """
    wraps = 0
    for (a, b), (p, q) in zip(pairwise(low), pairwise(high), strict=True):
        wrap = 1 if b - a < -_FULL // 2 else -1 if b - a > _FULL // 2 else 0
        if (q - p) % _FULL != wrap % _FULL:
            return None
        wraps += wrap != 0
    return wraps > 0
