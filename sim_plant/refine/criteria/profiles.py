"""Criteria of named profiles: when other names, ages and details of them are tried."""

from __future__ import annotations

from dataclasses import dataclass

from sim_plant.refine.criteria.criterion import criterion


@dataclass(frozen=True, slots=True, kw_only=True)
class ProfileCriteria:
    """Under which names, with which age and details a profile is fitted."""

    strong: float = criterion(
        1e5,
        "chi2",
        "cost explained from which a profile is also fitted as formed at another radius",
        "ADR 0015, on the pairs of data/lines",
    )
    weak: float = criterion(
        1e4,
        "chi2",
        "cost explained up to which responses to declared numbers are not taken anew",
        "the second order of effects and tolerances is less than noise",
    )
    most_names: int = criterion(
        2,
        "1",
        "other names, of the most similar profiles, under which a strong one is fitted",
        "an outline has flanks or a flat; an ellipse or a flat spot near by is behind both",
    )
    age_room: float = criterion(
        3.0,
        "of the distance of its bounds",
        "width of an age's interval, by the slopes where its fit would begin, from which no age "
        "is fitted",
        "after a fit an age is kept up to a width of 1; three times that allows for slopes that "
        "differ between where a fit begins and where it ends",
    )
