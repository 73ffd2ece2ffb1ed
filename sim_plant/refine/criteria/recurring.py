"""Criteria of an unexplained rhythm: something that is left again and again."""

from __future__ import annotations

from dataclasses import dataclass

from sim_plant.refine.criteria.criterion import criterion


@dataclass(frozen=True, slots=True, kw_only=True)
class RecurringCriteria:
    """When how much is left repeats."""

    harmonics: int = criterion(
        6,
        "harmonics",
        "of a rhythm that are looked at",
        "what lasts for a third of its period, or less, has six",
    )
    harmonics_shown: int = criterion(
        3,
        "harmonics",
        "of those, the first among them, that have to be strong",
        "what is there for half of its period has the first, third and fifth alone",
    )
    strength: float = criterion(
        4.0,
        "power over that beside it",
        "from which a harmonic is strong",
        "528 spectra of seeded noise: up to 2.4; loops that hunt: up to 3.1; words that stand "
        "still: 5.4 to 14, and along other axes up to 3.6",
    )
    beside_bins: int = criterion(
        97,
        "half bins",
        "over which the median is taken that is beside a harmonic",
        "0.8 Hz of 60 s: wide against a line, narrow against what a loop shapes",
    )
    skirt_bins: float = criterion(
        4.0,
        "half bins",
        "above the lowest frequency that is strong, in which the fundamental is",
        "a strong spectral line has skirts of two bins",
    )
    resolved_cycles: float = criterion(
        1.0,
        "cycles in the record",
        "a spectral line that is off a harmonic of the rhythm by less is that harmonic",
        "theory: two frequencies that drift apart by less than a cycle have one peak",
    )
    alike_share: float = criterion(
        0.7,
        "of the strongest",
        "axes of which the rhythm is not told from that",
        "at one speed all are alike; where speed changes by a tenth in 60 s a rhythm of 1 s "
        "spreads over some ten bins",
    )
