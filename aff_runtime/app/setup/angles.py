"""Which words are a roll's angle: their rate against line speed over radius, their wrap."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from aff_runtime.app.setup.behaviour import Behaviour, Kind, behaviours
from aff_runtime.app.setup.decoding import HIGH_FIRST, LOW_FIRST, Decoding
from aff_runtime.app.setup.reading import Watched
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
FAR = 0.05  # share by which radius and line speed may be off together
LONGEST_S = 45.0
_FULL = 1 << 16


@dataclass(frozen=True, slots=True, kw_only=True)
class AngleCandidate:
    """One reading of words as an angle.

    Attributes
    ----------
    counts_per_turn : a usual number; negative when it counts against the web.
    measured : what rate, radius and line speed say.
    why : reasons; ``usable`` : False for a count that starts over within the word.
    """

    decoding: Decoding
    counts_per_turn: int
    measured: float
    why: tuple[str, ...]
    score: float
    usable: bool = True

    @property
    def scale_text(self) -> str:
        """Return the scale as the site file writes it."""
        return f"{self.counts_per_turn} counts/turn"


def angle_candidates(
    seen: Watched,
    *,
    speed_m_s: float,
    radius_m: float,
    taken: frozenset[int] = frozenset(),
    order: str = "",
) -> list[AngleCandidate]:
    """Return the words that can be the angle of a roll, best first.

    Parameters
    ----------
    speed_m_s, radius_m : of the web and of the roll while the words were watched, above 0.
    order : word order of the PLC where it is known.
    """
    found = []
    for address, does in behaviours(seen).items():
        if address in taken or does.kind not in (Kind.COUNTER, Kind.RAMP):
            continue
        measured = does.rate_per_s * 2.0 * math.pi * radius_m / speed_m_s
        for counts in _usual(abs(measured)):
            off = abs(counts / abs(measured) - 1.0)
            signed = round(math.copysign(counts, measured))
            for decoding, score, why in _decodings(address, does, seen, taken, order):
                reasons = (f"measured {plain(float(f'{measured:.5g}'))} counts/turn", *why)
                found.append(
                    AngleCandidate(
                        decoding=decoding,
                        counts_per_turn=signed,
                        measured=measured,
                        why=reasons,
                        score=score + _usualness(counts) - 0.5 * (off / 0.01) ** 2,
                        usable=not does.restarts_at,
                    )
                )
    return sorted(found, key=lambda one: -one.score)


def has_wrapped(addresses: Sequence[int], seen: Watched) -> bool:
    """Return whether each of these words went through its end, which shows where the rest is."""
    does = behaviours(seen)
    return all(does[address].wraps > 0 for address in addresses if address in does)


def _usual(measured: float) -> list[int]:
    near = [one for one in USUAL_COUNTS if abs(one / measured - 1.0) < FAR] if measured else []
    return sorted(near, key=lambda one: abs(one - measured))[:3]


def _usualness(counts: int) -> float:
    return 0.7 if counts & (counts - 1) == 0 or counts % 1000 == 0 else 0.0


def _decodings(
    address: int, does: Behaviour, seen: Watched, taken: frozenset[int], order: str
) -> list[tuple[Decoding, float, tuple[str, ...]]]:
    """Return how the count may be stored: one word, or two with the carry in a neighbour."""
    if does.restarts_at:
        why = (
            f"starts over at {does.restarts_at}, not at 65536: AFF follows whole words alone. Let "
            "the PLC count on",
        )
        return [(Decoding(address=address, type="u16"), -5.0, why)]
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
        score = 6.0 if carry else (0.5 if name == order else -1.0 if order else -0.5)
        why = (f"word {high} takes its carry",) if carry else (f"no carry into {high} seen yet",)
        rows.append((decoding, score, why))
    wrapped = does.wraps > 0
    one = "wraps at 65536" if wrapped and not proved else "its low word" if proved else "one word"
    score = -2.0 if proved else 2.0 if wrapped else 0.0
    rows.append((Decoding(address=address, type="u16"), score, (one,)))
    return rows


def _carries(low: Sequence[int], high: Sequence[int]) -> bool | None:
    """Return True for a carry with every wrap, False where nothing was seen, None against it."""
    wraps = 0
    for (a, b), (p, q) in zip(pairwise(low), pairwise(high), strict=True):
        through = 1 if b - a < -_FULL // 2 else -1 if b - a > _FULL // 2 else 0
        if (q - p) % _FULL != through % _FULL:
            return None
        wraps += through != 0
    return wraps > 0
