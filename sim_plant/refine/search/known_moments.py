"""Moments at which something begins in a record, before it is known what."""

from __future__ import annotations

from collections.abc import Sequence

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.search.candidate import Candidate
from sim_plant.refine.search.distinct_events import moment_of
from sim_plant.refine.search.unknown_event import beginning

EVENTS = CRITERIA.search.events
OF_NUMBERS = "numbers"
"""The axis of moments of declared numbers, which has responses at `moments_known` alone."""


def axis_of(h: Hypothesis) -> str:
    """Return which axis of moments an effect has: that of its unit, or that of numbers."""
    onset = h.effect.onset
    return OF_NUMBERS if h.effect.shifted_by else onset.unit if onset is not None else ""


def moments_known(
    seen: Sequence[Candidate], white: Array, first: int, sample_s: float
) -> tuple[float, ...]:
    """Return the moments, s, at which something begins in a record, as far as is known.

    Where the best effects of ``seen`` begin, and where what is left (``white``, from the sample
    ``first`` on) gets louder. Whatever a declared number changes when it becomes another one, one
    of them sees it: so numbers, which are many, are tried there alone, and in a record without
    any such moment not at all. A number also shows by what the references do after that moment,
    so its response is simulated at it, to half a second, and not shifted from elsewhere.
    """
    timed = [
        c for c in seen if c.hypothesis.effect.onset and c.hypothesis.effect.onset.unit == "s"
    ]
    timed = sorted((c for c in timed if c.score > EVENTS.least_chi2), key=lambda c: -c.score)
    moments: list[float] = []
    for c in timed:
        if all(abs(moment_of(c) - m) > EVENTS.known_apart_s for m in moments):
            moments.append(moment_of(c))
        if len(moments) == EVENTS.most_moments:
            break
    louder = beginning(white**2, sample_s)
    if louder is not None:
        moments.append((first + louder) * sample_s)
    last_s = (first + white.shape[1]) * sample_s
    steps = {round(m / EVENTS.bin_s) for m in moments}
    return tuple(s * EVENTS.bin_s for s in sorted(steps) if 0.0 < s * EVENTS.bin_s < last_s)
