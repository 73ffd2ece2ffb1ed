"""Criteria for records without a line declaration."""

from __future__ import annotations

from dataclasses import dataclass, field

from sim_plant.refine.criteria.criterion import NOT_RECORDED, criterion
from sim_plant.refine.criteria.general import GeneralCriteria


@dataclass(frozen=True, slots=True, kw_only=True)
class WithoutLineCriteria:
    """What is a spectral line, and what a clock, in records without a line declaration."""

    general: GeneralCriteria = field(default_factory=GeneralCriteria)
    rows_beyond_taps: int = criterion(
        100,
        "rows",
        "that are left to judge when the filter has taken its taps off both ends",
        NOT_RECORDED,
    )
    lower_share: float = criterion(
        1.001,
        "1",
        "of two fundamentals with as many orders the higher one counts, from this ratio on",
        "nearer ones are one fundamental read off two spectral lines",
    )
    onward_share: float = criterion(
        0.9, "of the rows", "a travel speed is above 0 in at least as many", NOT_RECORDED
    )
    sample_time_share: float = criterion(
        0.02, "1", "sample times of record and declaration differ by less", NOT_RECORDED
    )
    false_alarm: float = criterion(
        1e-4,
        "per record",
        "probability that noise shows a spectral line, before ``safety``",
        "decision: one record in ten thousand, by chi-square theory",
    )
    safety: float = criterion(
        1.5,
        "of the theoretical threshold",
        "a spectral line needs more",
        "residuals are not quite white",
    )
    bins: int = criterion(
        5,
        "independent coordinates",
        "within the reach in which a spectral line is looked for in one record alone",
        NOT_RECORDED,
    )
    speed_share: float = criterion(
        3e-4,
        "of an order",
        "error of an order where a mean speed turned Hz into 1/m",
        NOT_RECORDED,
    )
    clock_safety: float = criterion(
        1.2, "of the theoretical threshold", "a clock in a raw output needs more", NOT_RECORDED
    )
    most_spectral_lines: int = criterion(
        12, "spectral lines", "are taken out at most", NOT_RECORDED
    )
    clock_share: float = criterion(
        0.002, "1", "a spectral line this close to a clock is that clock", NOT_RECORDED
    )
    highest_divisor: int = criterion(
        20, "samples", "a clock of the recorder is no slower", NOT_RECORDED
    )
    mains_Hz: tuple[float, ...] = criterion(
        (50.0, 60.0), "Hz", "frequencies of the mains", "the world's grids"
    )
    fewest_cycles: float = criterion(
        5.0, "cycles per record", "a slower spectral line is not looked for", NOT_RECORDED
    )
    highest_frequency_share: float = criterion(
        0.49, "of the sample rate", "a faster spectral line is not looked for", NOT_RECORDED
    )
    highest_travel_share: float = criterion(
        0.49,
        "of samples per metre at the mean speed",
        "a finer spectral line is not looked for",
        NOT_RECORDED,
    )
    highest_wavenumber_1_m: float = criterion(
        48.0,
        "1/m",
        "nor one above this",
        "a speed column that counts turns has orders there: 24 and their doubles",
    )
    axis_share: float = criterion(
        0.1,
        "of the chi-square reduction",
        "by how much a spectral line has to be stronger in time than in travel, or the other way "
        "round, for one record with a varying speed to prove which it is",
        "decision: none is that much stronger by chance",
    )
    sharp_share: float = criterion(
        0.002,
        "of a frequency",
        "so far at least around it a spectral line is sharpened in one record, or 1 / extent",
        "below the 0.003 by which spectral lines at known frequencies are the same",
    )
    sharp_points: int = criterion(
        21,
        "frequencies",
        "of the grid on which it is sharpened, at least",
        "theory: a tenth of what is searched on either side",
    )
    sharp_narrows: float = criterion(
        0.15,
        "of the width before",
        "width of the next grid, around the best",
        "theory: the best is within a tenth; half as much again",
    )
    sharp_passes: int = criterion(
        3,
        "grids",
        "by which it is sharpened",
        "theory: the last has steps of 0.002 / extent, 0.014 rad over the record",
    )
    presence_points: int = criterion(
        9,
        "frequencies",
        "within 1 / extent on either side of a spectral line, at which it is looked for",
        "theory: four per 1 / extent lose at most 5 % of its chi2 between two, 1 - sinc(1/8)^2",
    )
    highest_order: int = criterion(
        40, "per turn", "highest multiple of a fundamental that a spectral line can be", "decision"
    )
    fewest_orders: int = criterion(
        3, "spectral lines", "that share a fundamental before they are orders of it", "decision"
    )
    order_share: float = criterion(
        0.03, "of the fundamental", "an order is no further off a whole number", "decision"
    )
    chance: float = criterion(
        0.02,
        "1",
        "spectral lines at random are orders of one fundamental less often",
        "decision: each has to be that close to a whole multiple, for all fundamentals tried",
    )
