"""Criteria for records without a line declaration."""

from __future__ import annotations

from dataclasses import dataclass, field

from sim_plant.refine.criteria.criterion import NOT_RECORDED, criterion


@dataclass(frozen=True, slots=True, kw_only=True)
class GeneralCriteria:
    """When a general effect is claimed, in records without a line declaration."""

    blocks: int = criterion(
        20,
        "blocks",
        "in all records together, each left out in turn",
        "enough for a standard error; each is longer than the noise remembers",
    )
    fewest_blocks: int = criterion(6, "blocks", "of one record", "alternate ones judge each other")
    least_share: float = criterion(
        0.003,
        "of the squared error of blocks left out",
        "an effect that saves less is not claimed",
        "decision: 0.15 % of the rms is not worth reporting",
    )
    least_t: float = criterion(
        4.0,
        "standard errors",
        "least mean of what an effect saves in the blocks",
        "Student's t of 20 blocks: 4e-4 by chance; some 50 candidates are tried, and each has to "
        "save its share as well",
    )
    filter_share: float = criterion(
        0.001,
        "of the squared error of blocks left out",
        "a longer filter that saves less is not taken",
        "decision: a twentieth of a percent of the rms",
    )
    most_effects: int = criterion(6, "effects", "are added to a filter at most", "decision")
    shift_reach: int = criterion(
        200,
        "samples",
        "channels are not shifted by more",
        "2 s at 10 ms; and never more than the taps",
    )
    least_delay_samples: float = criterion(
        0.05, "samples", "a shorter mean shift between channels is no delay", NOT_RECORDED
    )
    least_side_share: float = criterion(
        0.02,
        "of the samples",
        "a state on one side of zero for less has no two signs, and no friction by sign",
        NOT_RECORDED,
    )
    soft_sign_share: float = criterion(
        0.002,
        "of the rms of a state",
        "state below which its sign counts for less than 1",
        "so close to zero it is the sign of noise",
    )
    slow_state_s: float = criterion(
        0.4, "s", "mean over which a gain's state is taken", "what is faster is the input itself"
    )
    standardised: float = criterion(
        1e-6,
        "unit of the input",
        "a column whose mean and standard deviation are this close to 0 and 1 was standardised",
        NOT_RECORDED,
    )


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
