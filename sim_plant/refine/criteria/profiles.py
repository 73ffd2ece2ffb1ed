"""Criteria of named profiles: when other names and radii of formation are tried."""

from __future__ import annotations

from dataclasses import dataclass

from sim_plant.refine.criteria.criterion import criterion


@dataclass(frozen=True, slots=True, kw_only=True)
class ProfileCriteria:
    """Under which names, and as formed at which radius, a profile is fitted.

    A profile's age is by how much the radius has fallen since it was formed, m.
    """

    strong: float = criterion(
        1e5,
        "chi2",
        "cost that all effects explain together, from which a profile is also fitted as formed at "
        "another radius, and under other names",
        "ADR 0015, on the pairs of data/lines",
    )
    weak: float = criterion(
        1e4,
        "chi2",
        "cost that all effects, each locked to an order, explain together, below which responses "
        "to declared numbers are not simulated anew with them",
        "what an effect and a shift within tolerance do only together is less than noise",
    )
    most_names: int = criterion(
        2,
        "1",
        "most similar names, its own among them, under which an outline is fitted",
        "names are alike in their low orders at one radius: pair 22 of data/cases/train",
    )
    age_rounds: int = criterion(
        8,
        "Gauss-Newton steps",
        "at most, of a fit of a profile as formed at another radius",
        "it starts as far off as a radius of formation may be: two more than from a first look",
    )
    age_room: float = criterion(
        3.0,
        "of the distance of its bounds",
        "width of an age's interval, by the slopes where its fit would begin, from which no age "
        "is fitted",
        "after a fit an age is kept up to a width of 1; three times that allows for slopes that "
        "differ between where a fit begins and where it ends",
    )
