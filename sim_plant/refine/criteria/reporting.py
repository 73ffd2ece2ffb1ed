"""Criteria for what is reported, and for records without a line declaration."""

from __future__ import annotations

from dataclasses import dataclass

from sim_plant.refine.criteria.criterion import NOT_RECORDED, criterion


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportCriteria:
    """What a report says of numbers that were found."""

    confidence: float = criterion(
        0.95, "probability", "of the intervals that a verdict gives", "convention"
    )
    model_share: float = criterion(
        0.0066,
        "of a size",
        "standard deviation of a size because no model is exact",
        "lines that other code simulated, one record each: a flat spot 1.2 %, a delay 0.8 %, a "
        "modulus 0.5 %, an eccentricity 0.3 % off; noise alone would promise a hundredth of that",
    )
    above_noise: float = criterion(
        1.1, "after over floor", "a channel from here on holds more than noise", NOT_RECORDED
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
class WithoutLineCriteria:
    """What is a line, and what a clock, in records without a line declaration."""

    rows_beyond_taps: int = criterion(
        100,
        "rows",
        "that are left to judge when the filter has taken its taps off both ends",
        NOT_RECORDED,
    )
    onward_share: float = criterion(
        0.9, "rows", "share of the rows in which a travel speed is above 0", NOT_RECORDED
    )
    sample_time_share: float = criterion(
        0.02, "1", "sample times of record and declaration differ by less", NOT_RECORDED
    )
    false_alarm: float = criterion(
        1e-4,
        "per record",
        "probability that noise shows a line",
        "one record in ten thousand, by chi-square theory",
    )
    safety: float = criterion(
        1.5, "of the theoretical threshold", "a line needs more", "residuals are not quite white"
    )
    clock_safety: float = criterion(
        1.2, "of the theoretical threshold", "a clock in a raw output needs more", NOT_RECORDED
    )
    most_spectral_lines: int = criterion(12, "lines", "are taken out at most", NOT_RECORDED)
    clock_share: float = criterion(0.002, "1", "a line this close to a clock is one", NOT_RECORDED)
    highest_divisor: int = criterion(
        20, "samples", "a clock of the recorder is no slower", NOT_RECORDED
    )
    mains_Hz: tuple[float, ...] = criterion(
        (50.0, 60.0), "Hz", "frequencies of the mains", "the world's grids"
    )
    fewest_cycles: float = criterion(
        5.0, "cycles per record", "a slower line is none", NOT_RECORDED
    )
    highest_frequency_share: float = criterion(
        0.49, "of the sample rate", "a faster line is none", NOT_RECORDED
    )
    highest_travel_share: float = criterion(
        0.25, "of samples per metre at the mean speed", "a finer line is none", NOT_RECORDED
    )
    highest_wavenumber_1_m: float = criterion(12.0, "1/m", "nor is one above this", NOT_RECORDED)
