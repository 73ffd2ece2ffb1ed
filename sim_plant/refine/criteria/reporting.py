"""Criteria for what is reported, and for records without a line declaration."""

from __future__ import annotations

from dataclasses import dataclass, field

from sim_plant.refine.criteria.criterion import NOT_RECORDED, criterion


@dataclass(frozen=True, slots=True, kw_only=True)
class JudgeCriteria:
    """When a record held out refutes what was found on the records fitted."""

    least_power: float = criterion(
        1.0,
        "of the power of noise, mean over channels",
        "power beyond noise from which a record held out has something to explain",
        "below, what declared numbers leave within their tolerance is as much",
    )
    refuted_share: float = criterion(
        0.5,
        "of that power beyond noise",
        "effects that leave more of it are refuted, unless the record shows their own response",
        "right effects leave 0.01 to 0.1 (refine-pairs); half is beyond a model's error",
    )
    slope_off: float = criterion(
        0.5,
        "1",
        "a record shows a response if its slope on it is this close to 1, chance included",
        "a response that is there has slope 1, one that is not 0; at 1 - 0.5 and 1 + 0.5 the "
        "effect takes no power away, or leaves a third of what it explains",
    )
    slope_sd: float = criterion(
        2.0, "standard deviations", "of that slope which count as chance", "95 %"
    )
    slope_blocks: int = criterion(
        20,
        "blocks",
        "of a record, by whose scatter that standard deviation is told",
        "each is longer than noise remembers, 2 s of 40 s, and 20 tell a variance",
    )
    taken_share: float = criterion(
        1.0,
        "of the power that is left beyond noise",
        "beside others, an effect that takes less away from a record held out is not claimed, "
        "unless that record shows its response and it takes more than the others' models can "
        "leave (search.unexplained.remainder_share of what all explain)",
        "what a strong effect's model leaves can be imitated; an imitation takes part of it",
    )
    worse_power: float = criterion(
        0.25,
        "of the power of noise, in one channel of force or speed",
        "beside something unknown, an effect that adds more to a record held out is not there",
        "what is there takes power away wherever it shows; right ones add up to 0.06 (cases)",
    )
    mains_share: float = criterion(
        0.004,
        "of the frequency",
        "how far from the fitted one the mains are sought in a record held out",
        "a grid's steady state stays within 0.2 Hz of 50 Hz [ENTSO-E]",
    )
    standing_power: float = criterion(
        0.1,
        "of the power of noise, mean of all channels but angles",
        "an event that takes so much away is there, though it began before what is judged",
        "a steady force counts nothing where zeros are free; noise alone moves the mean by 0.02",
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class RangeCriteria:
    """How the ends of an interval are found for what a line does not answer to in proportion."""

    looks: int = criterion(
        7,
        "values",
        "at which a number is held on the way to one end",
        "2^6 = 64 times the expected width",
    )
    near_share: float = criterion(
        0.3,
        "of the rise of the cost at an end",
        "a value whose rise is this close to it is the end",
        "15 % of the width",
    )
    between_share: float = criterion(
        0.8,
        "of the nearest value beyond the end",
        "two values this close hold the end between them",
        "the cost is taken to grow with the square in between",
    )
    corrections: int = criterion(
        2,
        "steps",
        "at most, by which all other numbers are fitted to one that is held",
        "the slopes are known",
    )
    passes: int = criterion(
        2,
        "passes",
        "at most: a walk may find numbers that explain more",
        "one mends, one confirms",
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportCriteria:
    """How sure reported numbers are, and what the report leaves out."""

    confidence: float = criterion(
        0.95, "probability", "of the intervals that a verdict gives", "convention"
    )
    model_share: float = criterion(
        0.0066,
        "of a size",
        "standard deviation of a size that the error of any model adds",
        "lines that other code simulated, one record each: a flat spot 1.2 %, a delay 0.8 %, a "
        "modulus 0.5 %, an eccentricity 0.3 % off; noise alone would promise a hundredth of that",
    )
    interval_s: float = criterion(
        2.0,
        "s",
        "within which the error of a model moves a number in one direction",
        "a zone answers within seconds; a minute has 30 of them, enough for a variance",
    )
    ranges: RangeCriteria = field(default_factory=RangeCriteria)
    above_noise: float = criterion(
        1.1, "after over floor", "a channel from this ratio on holds more than noise", NOT_RECORDED
    )
    smallest_start_m: float = criterion(
        1e-6, "m", "orders of a start shape below this are left out", NOT_RECORDED
    )
    highest_start_order: int = criterion(
        16, "orders of the roll", "a start shape has no finer ones", NOT_RECORDED
    )
    block_settle_s: float = criterion(
        6.0, "s", "settling time that an AFF block to paste begins with", NOT_RECORDED
    )
    block_limit_m_s: float = criterion(
        0.02, "m/s", "amplitude that an AFF block to paste is limited to", NOT_RECORDED
    )


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
    other_speed: float = criterion(
        1.02, "1", "mean speeds whose ratio is larger are two speeds", "as one_speed_share"
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
