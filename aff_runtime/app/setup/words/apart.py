"""Whether what was typed tells words apart, and which word moves when somebody moves it.

A load cell beside the right one often shows the same tension with the same scale. What a display
shows then fits both, and how well it fits says more of the ripple in each than of which it is.
"""

from __future__ import annotations

import statistics
from bisect import bisect_right
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import accumulate

from aff_runtime.app.setup.words.behaviour import Kind, behaviours
from aff_runtime.app.setup.words.candidates import Candidate, Observation
from aff_runtime.app.setup.words.decoding import Decoding, all_decodings, values
from aff_runtime.app.setup.words.reading import Watched
from aff_runtime.app.setup.words.wraps import way_of

ALIKE = 3.0
"""Of ``prior``, which is a logarithm: a scale 20 times less usual is no rival where both fit."""
CLOSE = 1.0  # of ``score``; a scale that is not round may be right too
NEAR = 0.05  # share of the typed value by which another load cell at one tension may be off
SMOOTHED_S = 0.2  # over which readings are averaged
STEP_S, HELD_STEPS = 0.25, 2
"""What moved first is looked for every ``STEP_S``, and has to be the same for so many steps."""
STRONG = 2.0
"""A word has moved when its way beyond its swing at rest is more than so many times that swing,
and than so many times way and swing of every other one: what is smaller could hide in them."""


def alike(rows: Sequence[Candidate]) -> list[Candidate]:
    """Return the first row, and those that fit what was typed as well as it does."""
    best = rows[0]
    return [best] + [
        one
        for one in rows[1:]
        if (one.is_round and one.prior > best.prior - ALIKE) or one.score > best.score - CLOSE
    ]


def without_halves(rows: Sequence[Candidate]) -> list[Candidate]:
    """Return the rows without those that read words of a likelier one with another round scale.

    A word is part of one quantity: the low word of a load cell fits any tension now and then. With
    the same scale both readings may be meant.
    """
    kept: list[Candidate] = []
    for one in sorted(rows, key=lambda one: -one.score):
        places = frozenset(one.decoding.addresses)
        likelier = [row for row in kept if not places.isdisjoint(row.decoding.addresses)]
        if not one.is_round or all(row.scale == one.scale for row in likelier if row.is_round):
            kept.append(one)
    return [one for one in rows if one in kept]


def neighbours(
    best: Candidate,
    rows: Sequence[Candidate],
    observations: Sequence[Observation],
    *,
    taken: frozenset[int],
) -> list[Candidate]:
    """Return other words that read nearly the same with the best one's scale, nearest first.

    With a scale that is not round every word fits; with that of the best one few do. A display
    that was read a moment ago, or shows a mean, may be off a quiet word by more than its noise,
    and within that of a word that ripples.
    """
    latest = observations[-1]
    does = behaviours(latest.seen)
    known = {one.decoding for one in rows if one.prior >= best.prior}
    found = []
    for decoding in all_decodings(latest.seen, signed=best.decoding.type.startswith("i")):
        if decoding in known or not taken.isdisjoint(decoding.addresses):
            continue
        width, order = decoding.type[1:], decoding.order
        if (width, order) != (best.decoding.type[1:], best.decoding.order):
            continue
        kinds = {does[place].kind for place in decoding.addresses}
        if kinds == {Kind.STILL} or kinds & {Kind.COUNTER, Kind.RAMP}:
            continue
        off = [
            best.scale * statistics.fmean(values(decoding, one.seen)) - one.shown.value
            for one in observations
            if all(place in one.seen.words for place in decoding.addresses)
        ]
        shown = [abs(one.shown.value) for one in observations]
        if len(off) == len(shown) and all(
            abs(x) < NEAR * y for x, y in zip(off, shown, strict=True)
        ):
            found.append(
                Candidate(
                    decoding=decoding,
                    scale=best.scale,
                    scale_text=best.scale_text,
                    is_round=best.is_round,
                    value=latest.shown.value + off[-1],
                    why=("near what was typed with the same scale", "moves"),
                    score=best.score,
                    prior=best.prior,
                )
            )
    return sorted(found, key=lambda one: abs(one.value - latest.shown.value))


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """What a candidate did while somebody moved the quantity, SI.

    Attributes
    ----------
    swing : its largest distance from its mean at rest.
    change : its largest distance from that mean afterwards.
    """

    candidate: Candidate
    swing: float
    change: float

    @property
    def way(self) -> float:
        """Return by how much it went beyond its swing."""
        return max(0.0, self.change - self.swing)

    @property
    def is_strong(self) -> bool:
        """Return whether it went clearly further than at rest."""
        return self.way > STRONG * self.swing

    def is_beyond(self, other: Change) -> bool:
        """Return whether it went clearly further than another one, and than that one's swing."""
        return self.way > STRONG * max(other.way, other.swing)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Course:
    """How far a candidate had gone at each time: ``most`` is the largest distance so far, SI."""

    candidate: Candidate
    swing: float
    times_s: Sequence[float]
    most: Sequence[float]

    def until(self, time_s: float) -> Change:
        """Return what it did until a time."""
        count = max(1, bisect_right(self.times_s, time_s))
        return Change(candidate=self.candidate, swing=self.swing, change=self.most[count - 1])


def first_moved(
    rows: Sequence[Candidate], rest: Watched, since: Watched
) -> tuple[list[Change], list[Candidate]]:
    """Return what each candidate did, the largest change first, and those of the word that moved.

    A change of tension comes to the next zones with the web: what went first decides, once it has
    held for half a second. Where several went at once, or none did, nothing counts as moved, and
    the changes are those of the whole time.
    """
    courses = [_course(one, rest, since) for one in rows]
    held: list[frozenset[Decoding]] = []
    for number in range(1, int(since.duration_s / STEP_S) + 1):
        found = _sorted(one.until(number * STEP_S) for one in courses)
        best = moved(found)
        held.append(frozenset(one.decoding for one in best))
        if best and len(held) > HELD_STEPS and len(set(held[-1 - HELD_STEPS :])) == 1:
            return found, best
    return _sorted(one.until(since.duration_s) for one in courses), []


def moved(found: Sequence[Change]) -> list[Candidate]:
    """Return the candidates of the word that moved; none where none did, or several did alike."""
    if not found or not found[0].is_strong:
        return []
    best = frozenset(found[0].candidate.decoding.addresses)
    others = [one for one in found if best.isdisjoint(one.candidate.decoding.addresses)]
    if not all(found[0].is_beyond(one) for one in others):
        return []
    return [one.candidate for one in found if one not in others]


def _course(one: Candidate, rest: Watched, since: Watched) -> _Course:
    before = _smoothed(values(one.decoding, rest), rest)
    after = _smoothed(values(one.decoding, since), since)
    si_per_count = abs(one.scale)
    mean, swing = _at_rest(before)
    return _Course(
        candidate=one,
        swing=si_per_count * swing,
        times_s=since.times_s[len(since.times_s) - len(after) :],
        most=list(accumulate((si_per_count * abs(value - mean) for value in after), max)),
    )


def _sorted(found: Iterable[Change]) -> list[Change]:
    return sorted(found, key=lambda one: -one.way)


def words_that_moved(rest: Watched, since: Watched) -> list[int]:
    """Return the words, of any meaning, that went further than at rest; counters are left out."""
    does = behaviours(since)
    found = []
    for address, series in since.words.items():
        if does[address].kind in (Kind.COUNTER, Kind.RAMP):
            continue
        path = way_of([rest.words[address][-1], *series])[1:]
        before = _smoothed(way_of(rest.words[address]), rest)
        zero = way_of(rest.words[address])[-1]
        mean, swing = _at_rest(before)
        way = max(abs(zero + value - mean) for value in _smoothed(path, since)) - swing
        if way > STRONG * swing:
            found.append(address)
    return found


def _at_rest(before: Sequence[float]) -> tuple[float, float]:
    """Return the mean, and the largest distance from it, both in counts; at least one count."""
    mean = statistics.fmean(before)
    return mean, max(1.0, *(abs(value - mean) for value in before))


def _smoothed(series: Sequence[float], seen: Watched) -> list[float]:
    """Return means over ``SMOOTHED_S``: a single reading is no movement."""
    period_s = seen.duration_s / max(1, len(seen.times_s) - 1)
    count = max(1, min(len(series), round(SMOOTHED_S / period_s) if period_s else 1))
    sums = list(accumulate(series, initial=0.0))
    return [(end - begin) / count for begin, end in zip(sums, sums[count:], strict=False)]
