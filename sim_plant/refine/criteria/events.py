"""Criteria of effects that begin at a moment, and of an unexplained event in the residual."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from sim_plant.refine.criteria.criterion import DEVELOPMENT, criterion


@dataclass(frozen=True, slots=True, kw_only=True)
class EventCriteria:
    """How the moment at which an effect begins is found."""

    response_moments: int = criterion(
        4,
        "moments",
        "of a record at which a response is simulated; for others the nearest is shifted",
        "speed and radius change little over a quarter of a record",
    )
    window: Mapping[str, float] = criterion(
        {"s": 12.0, "m": 20.0},
        "unit of the moment",
        "length of the response that the matched filter uses",
        "a zone's time constant is some seconds; a seam is on the line for its length",
    )
    apart: float = criterion(
        1.0,
        "s or m",
        "least distance of two moments of one effect; half as much again is searched around one",
        "what is closer is taken for one event",
    )
    before_step: Mapping[str, float] = criterion(
        {"s": 1.0, "m": 0.1},
        "unit of the moment",
        "step between moments that are tried before the judged part of a record held out",
        "a seam passes a roller within its length, some 0.1 m; no filter sees what is not judged",
    )
    wide_step_s: float = criterion(
        3.0,
        "s",
        "step between moments at which an effect that lasts is tried",
        "a zone's time constant",
    )
    around: tuple[float, ...] = criterion(
        (-1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5),
        "of apart",
        "distances of the moments that are tried around the best of those",
        "half of wide_step_s on either side, which is what lies between two of them",
    )
    known_apart_s: float = criterion(
        3.0,
        "s",
        "least distance of two moments at which declared numbers are tried",
        "one response, shifted, serves what is nearer: a zone's time constant",
    )
    ends_step_s: float = criterion(
        1.5,
        "s",
        "step between moments of the whole record at which an episode may begin and end",
        "an episode whose edges are both off by half a step still shows: zones forget in seconds",
    )
    episode_step_s: float = criterion(
        0.5,
        "s",
        "step between beginnings, and between ends, of an episode",
        "a fit finds an edge from a fraction of its rise, which is 0.5 s at the least",
    )
    beside_edge: tuple[float, ...] = criterion(
        tuple(-0.8 + 0.2 * k for k in range(9)),
        "of episode_step_s",
        "distances of the edges that are tried beside the best beginning and end",
        "a fifth of the rise: a fit goes on from there; the next step is a moment of its own",
    )
    least_energy_share: float = criterion(
        0.1,
        "of the energy of a response",
        "a moment after which the record has less of it is not looked at",
        "theory: the noise of a size goes with the root of it, 3.2 times that of a whole response",
    )
    episode_reach_s: float = criterion(
        4.0,
        "s",
        "farthest distance of an episode's beginning from the moment that the filter gives; two "
        "of an effect at a place that begin within it are one",
        "the filter has another length: its moment is off by half of the difference",
    )
    most_peaks: int = criterion(2, "1", "moments taken from one response", DEVELOPMENT)
    most_moments: int = criterion(
        2,
        "moments",
        "at which an effect at a place is tried; and of effects found, at which numbers are tried",
        DEVELOPMENT,
    )
    most_places: int = criterion(
        4, "1", "pairs of place and moment at which one effect is tried", DEVELOPMENT
    )
    least_chi2: float = criterion(
        60.0,
        "chi2",
        "least that an event has to explain, by a matched filter or on grids, and that one placed "
        "anew has to gain",
        "chance gives 2 ln of all moments and places, 25, model error about as much; rounded up",
    )
    least_share: float = criterion(
        0.3,
        "1",
        "share of the score that acceptance needs; events that explain less at first are dropped",
        "a filter of another length, or a place near by, sees a half and more; grids of moments "
        "and shapes find the rest",
    )
    most_candidates: int = criterion(
        5, "1", "effects at a moment that are simulated on grids", DEVELOPMENT
    )
    best_share: float = criterion(
        0.4, "1", "share of the best filter's chi2; effects below it are dropped", DEVELOPMENT
    )
    passes: int = criterion(
        3,
        "1",
        "passes over moments and shape parameters in turn; with each the step of the first one's "
        "grid (a place in a zone) halves",
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
    moment_penalty: float = criterion(
        14.0, "chi2", "penalty for choosing a moment", "2 ln of 1200 moments of 50 ms in a minute"
    )
    most_told: int = criterion(
        4, "1", "events that the progress text names", "a screen has few file lines"
    )
    judged_peaks: int = criterion(
        4,
        "peaks",
        "of the matched filter of a further record, around which a moment is looked for",
        "the event and what looks like it one roller further, before and behind",
    )
    level_share: float = criterion(
        0.1,
        "of the record, from its start",
        "whose median is the level to which later bins are compared",
        "a later event has its full power above it; of an earlier one the record shows no onset",
    )
    sample_power: float = criterion(
        25.0,
        "of the power of noise",
        "a sample of a channel counts no more where something begins",
        "five standard deviations, which noise does not reach: a spike in one sample adds 0.05 to "
        "a bin of 450, less than bin_sd asks, and what lasts moves most of them",
    )
    lasts_sd: float = criterion(
        3.0,
        "standard deviations",
        "by which what begins is louder than before it without its loudest part of the length "
        "of the noise filter",
        "whitened, a spike of 1000 standard deviations is 25 samples of five and more; of 200 "
        "seeded sets with one, 1 is told as an event with 3 channels, none with 6",
    )
    bin_s: float = criterion(
        0.5,
        "s",
        "length over which the residual's power is averaged; declared numbers are tried at whole "
        "multiples of it",
        "some periods of a loop",
    )
    bin_sd: float = criterion(
        5.0,
        "standard deviations",
        "above the level of ``level_share`` from which a bin is loud",
        "a minute has 120 bins",
    )
    quiet_s: float = criterion(
        4.0, "s", "how long a record is quiet before an event, and louder after it", DEVELOPMENT
    )
    contrast: float = criterion(
        0.2,
        "1",
        "share of the noise power by which the residual's power rises at an event",
        DEVELOPMENT,
    )
