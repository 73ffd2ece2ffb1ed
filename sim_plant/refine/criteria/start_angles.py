"""Criteria of start angles: how finely, and in what steps, the angles of bodies are sought."""

from __future__ import annotations

from dataclasses import dataclass

from sim_plant.refine.criteria.criterion import NOT_RECORDED, criterion


@dataclass(frozen=True, slots=True, kw_only=True)
class StartAngleCriteria:
    """Grids of angles, then steps of all bodies together."""

    coarse_angles: int = criterion(
        24,
        "angles",
        "of the first grid at least",
        "every 15 deg of a turn, or a 24th of the part of one after which all that turns with a "
        "body is as it was",
    )
    angles_in_period: int = criterion(
        4,
        "angles",
        "of the first grid at least, in a period of what repeats most often per turn",
        "one is within an eighth of a period of the minimum, in the same valley of the cost",
    )
    zooms: int = criterion(
        3,
        "grids",
        "about the best try, after the first one",
        "of 24 tries a turn over 15, 4.5 and 1.35 deg",
    )
    zoom_parts: tuple[float, ...] = criterion(
        (-0.5, -0.25, 0.0, 0.25, 0.5), "of its width", "tries of such a grid", NOT_RECORDED
    )
    narrowing: float = criterion(
        0.3, "of the width of the one before", "width of the next such grid", NOT_RECORDED
    )
    most_passes: int = criterion(
        6,
        "passes",
        "over pairs of bodies, and steps of all bodies together, at most",
        "not recorded; each ends when nothing is won",
    )
    slope_rad: float = criterion(
        0.005,
        "rad",
        "angle over which a slope is taken",
        "at order 12 a thirtieth of what changes its sign",
    )
    most_rad: float = criterion(
        0.1,
        "rad",
        "longest step of all bodies together",
        "some 6 deg: slopes hold no further at order 12",
    )
    slope_order: float = criterion(
        12.0,
        "per turn",
        "order for which slope_rad and most_rad are set; of what repeats more often both are "
        "smaller, in proportion",
        "definition",
    )
