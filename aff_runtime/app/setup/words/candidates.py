"""Which words can be what a display shows: every register and decoding, ranked by reasons."""

from __future__ import annotations

import math
import statistics
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from aff_runtime.app.setup.words.behaviour import Behaviour, Kind, behaviours
from aff_runtime.app.setup.words.decoding import Decoding, all_decodings, values
from aff_runtime.app.setup.words.display import Shown
from aff_runtime.app.setup.words.reading import Watched
from aff_runtime.app.setup.words.scale_steps import round_scales
from aff_runtime.base.units import plain

SHOWN_BEST = 5
_RANGE = math.log(1e8)  # of the values that a word may show which is not the quantity
_NO_ROUND_SCALE = math.log(0.02)  # prior of any scale that is not round
_FURTHEST = 3.0  # standard deviations
_TRIED_SCALES = 40  # round ones, of one decoding
_CREEPS = 0.01  # share of its value by which a slow quantity changes in a second, at most
_TYPED_S = 5.0  # from reading a display to the last key; a roll shrinks meanwhile


@dataclass(frozen=True, slots=True, kw_only=True)
class Observation:
    """What the display showed while the words were watched."""

    shown: Shown
    seen: Watched


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidate:
    """One reading of one or two words as the quantity.

    Attributes
    ----------
    scale : SI in a count; ``scale_text`` : as the site file may write it.
    is_round : whether the scale is a round number of some unit.
    value : what it reads now, SI.
    why : reasons for and against, for eyes. ``score`` : log of how much better than chance.
    prior : the part of ``score`` that scale and behaviour say, before any value was typed.
    """

    decoding: Decoding
    scale: float
    scale_text: str
    is_round: bool
    value: float
    why: tuple[str, ...]
    score: float
    prior: float

    def because(self, reason: str) -> Candidate:
        """Return it with one more reason."""
        return replace(self, why=(*self.why, reason))


@dataclass(frozen=True, slots=True, kw_only=True)
class _Seen:
    """One decoding at one moment, in counts, and what the display showed.

    Attributes
    ----------
    mean, sd : while it was watched.
    late : by how much it may have changed since the display was read, rms.
    """

    mean: float
    sd: float
    late: float
    shown: Shown

    @property
    def scatter(self) -> float:
        """Return by how much the display may be off the mean, counts rms."""
        return math.hypot(self.sd, self.late)

    def off(self, scale: float) -> float:
        """Return how many standard deviations display and value read with ``scale`` are apart."""
        digit = self.shown.half_digit / math.sqrt(3.0)
        return abs(self.shown.value - scale * self.mean) / math.hypot(digit, self.scatter * scale)

    def surprise(self, scale: float) -> float:
        """Return -log P(a wrong word, read with ``scale``, shows the display's value)."""
        digit = self.shown.half_digit / math.sqrt(3.0)
        sigma = math.hypot(digit, self.scatter * scale) / abs(self.shown.value)
        # a normal curve of this width covers sqrt(2 pi) sigma of a range that is evenly likely
        return -math.log(min(1.0, 2.5 * sigma / _RANGE))

    def error_share(self) -> float:
        """Return the share of the value by which the display may be off at most."""
        digit = self.shown.half_digit / abs(self.shown.value)
        return digit + _FURTHEST * self.scatter / abs(self.mean)


def candidates(
    observations: Sequence[Observation],
    si_unit: str,
    *,
    signed: bool,
    moves: bool | None,
    taken: frozenset[int] = frozenset(),
    word_order: str = "",
) -> list[Candidate]:
    """Return what the words can be, best first; at least one observation is needed.

    Parameters
    ----------
    si_unit : of the quantity.
    signed : whether its word is called signed where nothing tells.
    moves : whether it is measured (never quite still) or set; None for what moves slowly.
    taken : words that are something else already.
    word_order : order of two words of the PLC where it is known; the other one is left out.
    """
    latest = observations[-1].seen
    behaviour_of = behaviours(latest)
    found: list[Candidate] = []
    for decoding in all_decodings(latest, signed=signed):
        if not taken.isdisjoint(decoding.addresses) or _is_other(decoding.order, word_order):
            continue
        moments = [_moment(decoding, one) for one in observations]
        if any(one is None for one in moments):
            continue
        found += _of_decoding(
            decoding, [one for one in moments if one is not None], si_unit, behaviour_of, moves
        )
    best: dict[Decoding, Candidate] = {}
    for one in sorted(found, key=lambda one: -one.score):
        best.setdefault(one.decoding, one)
    return list(best.values())


def _is_other(word_order: str, known: str) -> bool:
    return bool(word_order and known and word_order != known)


def _moment(decoding: Decoding, one: Observation) -> _Seen | None:
    """Return a decoding at one moment; None where a word is missing, or the mean is 0 counts."""
    if any(address not in one.seen.words for address in decoding.addresses):
        return None
    counts = values(decoding, one.seen)
    mean = statistics.fmean(counts)
    if abs(mean) < 0.5:
        return None
    sd = statistics.pstdev(counts)
    return _Seen(mean=mean, sd=sd, late=_late(one.seen.times_s, counts, mean), shown=one.shown)


def _late(times_s: Sequence[float], counts: Sequence[int], mean: float) -> float:
    """Return by how much a value that creeps one way changed while it was typed, counts rms.

    0 for all others.
    """
    if len(counts) < 3 or times_s[-1] <= times_s[0]:
        return 0.0
    rate, zero = statistics.linear_regression(times_s, counts)
    way = abs(rate) * (times_s[-1] - times_s[0])
    rest = statistics.fmean(
        (y - rate * t - zero) ** 2 for t, y in zip(times_s, counts, strict=True)
    )
    if math.sqrt(rest) > 0.1 * way or abs(rate) > _CREEPS * abs(mean):
        return 0.0
    return abs(rate) * _TYPED_S / math.sqrt(3.0)


def _of_decoding(
    decoding: Decoding,
    moments: Sequence[_Seen],
    si_unit: str,
    behaviour_of: Mapping[int, Behaviour],
    moves: bool | None,
) -> Iterator[Candidate]:
    """Yield the best round scale of one decoding, and the scale that follows from the values."""
    surest = min(moments, key=_Seen.error_share)
    implied = surest.shown.value / surest.mean
    sign, share = math.copysign(1.0, implied), min(surest.error_share(), 0.5)
    low, high = abs(implied) * (1.0 - share), abs(implied) * (1.0 + share)
    tried = [
        (scale, scale.log_prior, _fit(moments, sign * scale.si))
        for _, scale in zip(
            range(_TRIED_SCALES), round_scales(low, high, si_unit, surest.shown.unit), strict=False
        )
    ]
    fitting = [row for row in tried if row[2] is not None]
    habits, why = _habits(decoding, behaviour_of, moves)
    if moves is None and moments[-1].sd > _CREEPS * abs(moments[-1].mean):
        habits, why = habits - 5.0, (*why, "too much for what moves slowly")
    if fitting:
        scale, usual, fit = max(fitting, key=lambda row: row[1] + (row[2] or 0.0))
        prior = usual + habits + _resolution(scale.si, surest.shown)
        text = scale.text if sign > 0 else f"-{scale.text}"
        reasons = (f"{text} is round", *_agreement(moments, sign * scale.si), *why)
        yield _candidate(
            decoding, sign * scale.si, text, True, moments, reasons, prior, fit or 0.0
        )
    fit = _fit(moments, implied)
    if fit is not None:
        gained = fit - surest.surprise(implied)  # its value fits whatever the word is
        prior = _NO_ROUND_SCALE + habits + _resolution(abs(implied), surest.shown)
        text = plain(float(f"{implied:.4g}"))
        reasons = ("the scale is not round", *_agreement(moments, implied), *why)
        yield _candidate(decoding, implied, text, False, moments, reasons, prior, gained)


def _candidate(
    decoding: Decoding,
    scale: float,
    text: str,
    is_round: bool,
    moments: Sequence[_Seen],
    why: Sequence[str],
    prior: float,
    fit: float,
) -> Candidate:
    return Candidate(
        decoding=decoding,
        scale=scale,
        scale_text=text,
        is_round=is_round,
        value=scale * moments[-1].mean,
        why=tuple(why),
        score=prior + fit,
        prior=prior,
    )


def _fit(moments: Sequence[_Seen], scale: float) -> float | None:
    """Return by how much better than chance a scale explains the values, as a logarithm.

    None when it does not explain them.
    """
    total = 0.0
    for one in moments:
        off = one.off(scale)
        if off > _FURTHEST:
            return None
        total += one.surprise(scale) - 0.5 * off * off
    return total


def _agreement(moments: Sequence[_Seen], scale: float) -> tuple[str, ...]:
    if len({one.shown.value for one in moments}) < 2:
        return ()
    return (f"agrees at {len(moments)} moments",)


def _habits(
    decoding: Decoding, behaviour_of: Mapping[int, Behaviour], moves: bool | None
) -> tuple[float, tuple[str, ...]]:
    """Return what a word's behaviour adds to the score, and the reasons."""
    kinds = [behaviour_of[address].kind for address in decoding.addresses]
    if any(_runs(behaviour_of[address]) for address in decoding.addresses):
        return -8.0, ("it counts or ramps",)
    moving = any(kind is not Kind.STILL for kind in kinds)
    score, why = 0.0, list[str]()
    if moves is not None:
        score = 1.0 if moving is moves else -5.0 if moves else -3.0
    why.append("moves" if moving else "stands still")
    if len(kinds) == 2:
        high = decoding.addresses[0 if decoding.order == "high_first" else 1]
        if not behaviour_of[high].last and behaviour_of[high].kind is Kind.STILL:
            score -= 0.5  # the low word alone reads the same
        if behaviour_of[high].kind is Kind.NOISY and behaviour_of[high].sd > 2.0:
            score -= 4.0  # the high word of a measured value hardly moves
    return score, tuple(why)


def _runs(word: Behaviour) -> bool:
    """Return whether a word counts or turns; one that creeps, as a radius, may be measured."""
    if word.kind not in (Kind.COUNTER, Kind.RAMP):
        return False
    return word.wrap.seen > 0 or abs(word.rate_per_s) > _CREEPS * max(1.0, abs(word.mean))


def _resolution(scale: float, shown: Shown) -> float:
    """Return what a count loses that is far coarser or finer than the display's last digit."""
    ratio = scale / (2.0 * shown.half_digit)
    return -4.0 if ratio > 2.2 else -3.0 if ratio < 1e-5 else 0.0
