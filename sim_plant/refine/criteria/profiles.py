"""Criteria of named profiles: when their name, their age and their details are looked at."""

from __future__ import annotations

from dataclasses import dataclass

from sim_plant.refine.criteria.criterion import criterion


@dataclass(frozen=True, slots=True, kw_only=True)
class ProfileCriteria:
    """Under which names, with which age and details a profile is fitted."""

    strong: float = criterion(
        1e5,
        "chi2",
        "cost explained from which a profile is looked at for where it was formed",
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
        "names of profiles, the nearest first, that a strong one is fitted under",
        "an outline has flanks or a flat; an ellipse or a flat spot near by is behind both",
    )
    age_room: float = criterion(
        3.0,
        "of what is possible",
        "width of an age's interval, by the slopes where its fit would begin, from which none is "
        "made",
        "a fit keeps an age at 1 at the most; three times that is left to slopes that are others "
        "where it ends than where it begins",
    )
