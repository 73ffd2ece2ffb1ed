"""Criteria of effects that begin at a moment: how it is found, and when what is left is one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from sim_plant.refine.criteria.criterion import DEVELOPMENT, criterion


@dataclass(frozen=True, slots=True, kw_only=True)
class EventCriteria:
    """How the moment at which an effect begins is found."""

    references: int = criterion(
        4,
        "moments of a record",
        "at which a response is simulated; in between it is taken to be the same",
        "speed and radius change little over a quarter of a record",
    )
    window: Mapping[str, float] = criterion(
        {"s": 12.0, "m": 20.0},
        "unit of the moment",
        "of the response that the matched filter uses",
        "a zone's time constant is some seconds; a seam is on the line for its length",
    )
    apart: float = criterion(
        1.0, "s or m", "between two moments of one effect", "what is closer is one"
    )
    before_step: Mapping[str, float] = criterion(
        {"s": 1.0, "m": 0.1},
        "unit of the moment",
        "between moments tried before the judged part of a record held out",
        "a seam passes a roller within its length, some 0.1 m; no filter sees what is not judged",
    )
    wide_step_s: float = criterion(
        3.0, "s", "between moments at which what lasts is weighed", "a zone's time constant"
    )
    ends_step_s: float = criterion(
        1.5,
        "s",
        "between moments over the whole record at which what ends again may begin and end",
        "with both half a step off, what rises and is forgotten in seconds is still seen",
    )
    span_step_s: float = criterion(
        0.5,
        "s",
        "between beginnings and ends tried of what ends again; a fifth of it beside the best",
        "a fit finds an edge from a fraction of its rise, which is 0.5 s at the least",
    )
    span_reach_s: float = criterion(
        4.0,
        "s",
        "how far its beginning is from where the filter saw it",
        "the filter takes another length: its moment is off by half of the difference",
    )
    peaks: int = criterion(2, "moments", "per response", DEVELOPMENT)
    moments: int = criterion(2, "moments", "of an effect at a place are looked at", DEVELOPMENT)
    places: int = criterion(4, "places and moments", "of one effect are looked at", DEVELOPMENT)
    floor: float = criterion(
        60.0,
        "chi2",
        "least of a matched filter",
        "2 ln of all moments and places is 25, model error beside it as much",
    )
    least_share: float = criterion(
        0.3,
        "of the score that an effect needs to be accepted",
        "events that explain less at their first look are not looked at",
        "a filter of another length, or a place near by, sees a half and more; grids of moments "
        "and shapes find the rest",
    )
    looked_at: int = criterion(5, "effects and moments", "are simulated on grids", DEVELOPMENT)
    filter_share: float = criterion(
        0.4, "of the best filter", "effects below are not looked at", DEVELOPMENT
    )
    passes: int = criterion(
        3,
        "passes",
        "over moments and shapes by turns; where in a zone it is, is halved with each",
        "web passes a span of some 0.5 m in about a second, two rises of warm web: half a span",
    )
    coarse_grid: tuple[float, ...] = criterion(
        tuple(0.25 * k for k in range(-4, 5)),
        "s or m",
        "moments tried around a peak",
        "the filter takes the response of another moment",
    )
    fine_grid: tuple[float, ...] = criterion(
        (-0.15, -0.1, -0.075, -0.05, -0.025, 0.0, 0.025, 0.05, 0.075, 0.1, 0.15),
        "s or m",
        "moments tried around the best of those",
        "a seam on a wrap is found to its own length only",
    )
    price: float = criterion(
        14.0, "chi2", "of choosing a moment", "2 ln of 1200 moments of 50 ms in a minute"
    )
    most_told: int = criterion(4, "effects", "that progress names", "a screen has lines")
    block_s: float = criterion(0.5, "s", "of power that is compared", "some loops' periods")
    block_sd: float = criterion(
        5.0, "standard deviations of a block", "above which a block is loud", "120 blocks a minute"
    )
    quiet_s: float = criterion(
        4.0, "s", "that a record is quiet before, and louder after, an event", DEVELOPMENT
    )
    contrast: float = criterion(
        0.2,
        "of the power of noise",
        "by which what is left rises at a moment, where it is an event",
        DEVELOPMENT,
    )
