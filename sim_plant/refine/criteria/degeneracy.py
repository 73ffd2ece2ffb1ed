"""Criteria of what is told alike: two places and one, declared numbers and an effect."""

from __future__ import annotations

from dataclasses import dataclass

from sim_plant.refine.criteria.criterion import NOT_RECORDED, criterion


@dataclass(frozen=True, slots=True, kw_only=True)
class DegeneracyCriteria:
    """Whether two places explain as much as one, and declared numbers as an effect."""

    same_coordinate_share: float = criterion(
        0.003, "1", "rollers whose spectral lines of travel differ by less are alike", NOT_RECORDED
    )
    most_places: int = criterion(
        4, "places", "are looked at in pairs, the best first", NOT_RECORDED
    )
    paired_numbers: int = criterion(
        2, "numbers", "of an effect that is looked at in pairs: cos and sin", "definition"
    )
    outside_prior_sd: float = criterion(
        4.0,
        "prior standard deviations",
        "a declared number further off is tried as the effect that changes it; found first, its "
        "square is the least score of one whose interval is outside its tolerance (ADR 0053)",
        "not recorded; theory: chance takes one number so far in 1 of 16 000",
    )
    stand_in_sd: float = criterion(
        1.0,
        "prior standard deviations",
        "a declared number that is so much further off without an effect stood in for it",
        "half a tolerance; a drag of 230 chi2 moves six idlers by 1.8 each, a cell's zero by 8",
    )
    most_outside: int = criterion(
        3, "declared numbers", "are tried as effects, the furthest first", NOT_RECORDED
    )
    joint_sd: float = criterion(
        6.0,
        "standard deviations of chi-square",
        "declared numbers together further off than this are beyond tolerance",
        NOT_RECORDED,
    )
