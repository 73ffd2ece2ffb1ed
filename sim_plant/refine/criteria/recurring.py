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
        4,
        "harmonics",
        "of those that have to be strong",
        "of half the rhythm three are, of a third of it two",
    )
    strength: float = criterion(
        3.0,
        "power over that beside it",
        "from which a harmonic is strong",
        "seeded noise of three lines: the mean of six reaches 1.9",
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
    alike_share: float = criterion(
        0.7,
        "of the strongest",
        "axes of which the rhythm is not told from that",
        "at one speed all are alike; where speed changes by a tenth in 60 s a rhythm of 1 s "
        "spreads over some ten bins",
    )
