"""What a word does: stands still, counts, ramps, is noisy, has bits that change."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from itertools import pairwise

from aff_runtime.app.setup.words.reading import Watched
from aff_runtime.app.setup.words.wraps import NOT_SEEN, Steps, Wrap, signed_word, steps_of

FASTEST_SCAN_PER_S = 1100.0
SLOWEST_SCAN_PER_S = 5.0
_ROUND_PERIODS_MS = (1, 2, 4, 5, 8, 10, 12, 16, 20, 25, 32, 40, 50, 100, 200)
_UNEVEN_COUNTS = 3.0  # by which a counter of scans may be off a straight line
_MOST_BITS = 3  # that change in a word of bits
_LEAST_WAY = 12  # counts; less may be a swing
_CROOKED = 0.03  # share of the way by which a ramp may be off a straight line


class Kind(StrEnum):
    """What a word does."""

    STILL = "still"
    COUNTER = "counts up"
    RAMP = "ramps"
    NOISY = "noisy"
    BITS = "bits change"


@dataclass(frozen=True, slots=True, kw_only=True)
class Behaviour:
    """What one word did while it was watched.

    Attributes
    ----------
    last, mean, sd : the last reading as u16, mean and standard deviation as i16.
    rate_per_s : of a counter or ramp, counts per second with its sign; else 0.
    steps : of a counter or ramp, from each reading to the next; ``wrap`` : where it wraps.
    unevenness : of a counter or ramp, median distance from a straight line, counts.
    changed : the bits that changed, as a mask.
    """

    kind: Kind
    last: int
    mean: float
    sd: float
    rate_per_s: float = 0.0
    steps: Steps | None = field(default=None, repr=False)
    wrap: Wrap = NOT_SEEN
    unevenness: float = 0.0
    changed: int = 0

    @property
    def wraps_after(self) -> int:
        """Return the counts after which it wraps, where that is not 65536; 0 where it is."""
        return self.wrap.wraps_after

    def __str__(self) -> str:
        """Return it as text for eyes."""
        match self.kind:
            case Kind.COUNTER | Kind.RAMP:
                wraps = f", starts over at {self.wraps_after}" if self.wraps_after else ""
                return f"{self.kind} by {self.rate_per_s:.1f} a second{wraps}"
            case Kind.NOISY:
                return f"noisy: {self.mean:.1f} +- {self.sd:.1f}"
            case Kind.BITS:
                bits = [str(bit) for bit in range(16) if self.changed >> bit & 1]
                return f"bits that change: {', '.join(bits)}"
        return "still"


def behaviour(times_s: Sequence[float], series: Sequence[int]) -> Behaviour:
    """Return what a word did; ``series`` are its readings as u16."""
    changed = 0
    for a, b in pairwise(series):
        changed |= a ^ b
    signed = [signed_word(word) for word in (series if changed else series[-1:])]
    base = Behaviour(
        kind=Kind.STILL,
        last=series[-1],
        mean=statistics.fmean(signed),
        sd=statistics.pstdev(signed),
        changed=changed,
    )
    if not changed:
        return base
    moving = _moving(base, times_s, series)
    if moving is not None:
        return moving
    # bits 0 and 1 together: a number that is noisy by a few counts
    few = changed.bit_count() <= _MOST_BITS and len(set(series)) <= 1 << _MOST_BITS
    return _as(base, kind=Kind.BITS if (few and changed > 3) or changed in (1, 2) else Kind.NOISY)


def behaviours(seen: Watched) -> dict[int, Behaviour]:
    """Return what every watched word did, by wire address."""
    return {place: behaviour(seen.times_s, series) for place, series in seen.words.items()}


def _as(base: Behaviour, *, kind: Kind) -> Behaviour:
    return Behaviour(kind=kind, last=base.last, mean=base.mean, sd=base.sd, changed=base.changed)


def _moving(base: Behaviour, times_s: Sequence[float], series: Sequence[int]) -> Behaviour | None:
    """Return a counter or a ramp, None for what goes to and fro."""
    steps = steps_of(times_s, series)
    wrap = steps.wrap() if steps is not None else None
    if steps is None or wrap is None:
        return None
    path = steps.path(wrap.wraps_after, signed=wrap.signed)
    rate, unevenness = _line(times_s, path)
    way = abs(path[-1])
    if way < _LEAST_WAY or unevenness > _CROOKED * way + 1.0:
        return None
    is_scan = steps.usual > 0 and SLOWEST_SCAN_PER_S <= rate <= FASTEST_SCAN_PER_S
    is_counter = is_scan and unevenness < _UNEVEN_COUNTS
    return Behaviour(
        kind=Kind.COUNTER if is_counter else Kind.RAMP,
        last=base.last,
        mean=base.mean,
        sd=base.sd,
        changed=base.changed,
        rate_per_s=rate,
        steps=steps,
        wrap=wrap,
        unevenness=unevenness,
    )


def _line(times_s: Sequence[float], path: Sequence[int]) -> tuple[float, float]:
    """Return slope (counts/s) of the straight line through a path, and median distance from it.

    The median, since a reading that this machine noted late says nothing of the PLC.
    """
    slope, zero = statistics.linear_regression(times_s, path)
    far = [abs(y - slope * t - zero) for t, y in zip(times_s, path, strict=True)]
    return slope, statistics.median(far)


@dataclass(frozen=True, slots=True, kw_only=True)
class HeartbeatCandidate:
    """A word that may be the PLC's heartbeat; ``why`` says what speaks for it."""

    address: int
    period_ms: float
    why: tuple[str, ...]
    score: float


def heartbeats(seen: Watched) -> list[HeartbeatCandidate]:
    """Return the words that may be the PLC's heartbeat, best first."""
    candidates = []
    for address, does in behaviours(seen).items():
        if does.kind is not Kind.COUNTER or does.wraps_after:
            continue
        period_ms = 1e3 / does.rate_per_s
        nearest = min(_ROUND_PERIODS_MS, key=lambda ms: abs(ms - period_ms) / ms)
        off = abs(period_ms - nearest) / nearest
        why = [f"counts every {period_ms:.2f} ms"]
        score = -does.unevenness
        if off < 0.02:
            why.append(f"a scan of {nearest} ms")
            score += 3.0 * (1.0 - off / 0.02) + 1.0
        if does.unevenness < 1.0:
            why.append("evenly")
        candidates.append(
            HeartbeatCandidate(address=address, period_ms=period_ms, why=tuple(why), score=score)
        )
    return sorted(candidates, key=lambda one: -one.score)
