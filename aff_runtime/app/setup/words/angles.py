"""Which words are a roll's angle: counts in a turn by line speed and radius, and their wrap."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from itertools import pairwise

from aff_runtime.app.setup.words.behaviour import Behaviour, behaviours
from aff_runtime.app.setup.words.decoding import HIGH_FIRST, LOW_FIRST, Decoding
from aff_runtime.app.setup.words.reading import Watched
from aff_runtime.app.setup.words.turns import CountsPerTurn, counts_per_turn
from aff_runtime.app.setup.words.wraps import FULL, Steps, Wrap
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
    wraps_after : counts after which it wraps, where that is not all that its words hold; 0
        where it is. ``usable`` : False for a count that wraps after no whole turns.
    unseen_s : for how long its wrap was looked for and not seen; 0 where it was seen.
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
    unseen_s: float = 0.0
    leaves_none: str = ""

    @property
    def scale_text(self) -> str:
        """Return the scale as the site file writes it."""
        return f"{self.counts_per_turn} counts/turn"

    @property
    def is_held(self) -> bool:
        """Return whether the interval holds this number."""
        return self.measured.holds(self.counts_per_turn)

    @property
    def reading(self) -> tuple[int, int, int]:
        """Return its word, its counts per turn, and after how many it wraps."""
        return self.low_word, self.counts_per_turn, self.wraps_after

    def unseen(self, seconds: float) -> AngleCandidate:
        """Return it as one whose wrap was not seen in so many seconds."""
        why = (*self.why, f"its end was not seen in {seconds:.0f} s")
        return replace(self, unseen_s=seconds, why=why)

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
        if address in taken or did.steps is None:
            continue
        stored = _decodings(address, did, seen, taken, word_order)
        measure = cache(partial(_measured, did.steps, did.wrap, seen, speeds_m_s, radius_m))
        first = measure(did.wraps_after)
        for counts in _usual(first) if first is not None else ():
            for row in _rows(address, did, stored, counts):
                # what was seen of its wrap is off by some counts, whole turns are not
                measured = measure(row.wraps_after or did.wraps_after)
                if measured is not None:
                    one = _candidate(address, row, measured, counts)
                    is_seen = did.wrap.seen or any(each.carried for each in stored)
                    candidates.append(one if is_seen else one.unseen(seen.duration_s))
    return _sorted(candidates)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Row:
    """How a count may be stored, and why; ``wraps_after`` and ``usable`` as a candidate's.

    ``carried`` : whether another word was seen to take its carry.
    """

    decoding: Decoding
    score: float
    why: str
    carried: bool = False
    wraps_after: int = 0
    usable: bool = True


def _measured(
    steps: Steps,
    wrap: Wrap,
    seen: Watched,
    speeds_m_s: Sequence[float],
    radius_m: float,
    wraps_after: int,
) -> CountsPerTurn | None:
    path = steps.path(wraps_after, signed=wrap.signed)
    return counts_per_turn(seen.times_s, path, speeds_m_s, radius_m)


def _candidate(address: int, row: _Row, measured: CountsPerTurn, counts: int) -> AngleCandidate:
    off = abs(counts / abs(measured.counts) - 1.0)
    return AngleCandidate(
        decoding=row.decoding,
        counts_per_turn=round(math.copysign(counts, measured.counts)),
        measured=measured,
        low_word=address,
        why=(*_said(measured, counts), row.why),
        score=row.score + _usualness(counts) - 0.5 * (off / _OFF) ** 2,
        usable=row.usable,
        wraps_after=row.wraps_after,
    )


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


def doubt(rows: Sequence[AngleCandidate]) -> str:
    """Return why the best row is not sure; empty where it is.

    It has to stand alone, and its wrap to have been seen: before that a word may be the low one of
    two, or wrap at any count that it has not come to.
    """
    can_be = {one.reading for one in rows if one.is_held and not one.leaves_none}
    if len(can_be) != 1 or rows[0].reading not in can_be:
        return "another word or number can be it too"
    if rows[0].unseen_s:
        return (
            f"its end was not seen in {rows[0].unseen_s:.0f} s: watch again at a higher speed, or "
            "take one word or two, and where it starts over, from the PLC's manual"
        )
    return ""


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


def _whole_turns(wrap: Wrap, counts: int) -> int:
    """Return after how many counts a word wraps, as whole turns; 0 where it is none."""
    whole = round(wrap.counts / counts) * counts
    return whole if whole <= FULL and abs(wrap.counts - whole) <= wrap.tolerance else 0


def _rows(address: int, does: Behaviour, stored: Sequence[_Row], counts: int) -> list[_Row]:
    """Return how a count may be stored that has so many a turn.

    Parameters
    ----------
    stored : how, where it takes its whole word.
    """
    whole = _whole_turns(does.wrap, counts)
    decoding = Decoding(address=address, type="i16" if does.wrap.signed else "u16")
    if not does.wraps_after:
        if not does.wrap.seen or whole in (0, FULL) or any(row.carried for row in stored):
            return list(stored)
        why = f"starts over after {whole}"  # as likely, by what was seen
        return [*stored, _Row(decoding=decoding, score=1.0, why=why, wraps_after=whole)]
    if whole:
        why = f"starts over after {whole}"
        return [_Row(decoding=decoding, score=4.0, why=why, wraps_after=whole)]
    why = f"starts over at {does.wraps_after}, which is no whole turns. Let the PLC count on"
    return [_Row(decoding=decoding, score=-5.0, why=why, usable=False)]


def _decodings(
    address: int, does: Behaviour, seen: Watched, taken: frozenset[int], word_order: str
) -> list[_Row]:
    """Return how a count may be stored that takes its word, or two with the carry."""
    rows = []
    carries: Mapping[str, int] = {HIGH_FIRST: address - 1, LOW_FIRST: address + 1}
    proved = False
    for name, high in carries.items():
        if does.wraps_after or high not in seen.words or high in taken:
            continue
        carry = _carries(seen.words[address], seen.words[high])
        if carry is None:
            continue
        decoding = Decoding(address=min(address, high), type="i32", order=name)
        proved = proved or carry
        score = 6.0 if carry else (0.5 if name == word_order else -1.0 if word_order else -0.5)
        why = f"word {high} takes its carry" if carry else f"no carry into {high} seen"
        rows.append(_Row(decoding=decoding, score=score, why=why, carried=carry))
    wrapped = does.wrap.seen > 0
    one = "its low word" if proved else "wraps at 65536" if wrapped else "one word"
    score = -2.0 if proved else 2.0 if wrapped else 0.0
    return [*rows, _Row(decoding=Decoding(address=address, type="u16"), score=score, why=one)]


def _carries(low: Sequence[int], high: Sequence[int]) -> bool | None:
    """Return whether the high word takes the carry of the low one.

    True when it steps with every wrap and at no other time, None when it does not; False while
    there was no wrap.
    """
    wraps = 0
    for (a, b), (p, q) in zip(pairwise(low), pairwise(high), strict=True):
        wrap = 1 if b - a < -FULL // 2 else -1 if b - a > FULL // 2 else 0
        if (q - p) % FULL != wrap % FULL:
            return None
        wraps += wrap != 0
    return wraps > 0
