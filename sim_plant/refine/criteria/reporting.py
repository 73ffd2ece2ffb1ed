"""Criteria for what is reported: how sure numbers are, what is left out."""

from __future__ import annotations

from dataclasses import dataclass, field

from sim_plant.refine.criteria.criterion import NOT_RECORDED, criterion


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
class MomentCriteria:
    """How the ends of the interval of a moment are found."""

    growth: float = criterion(
        1.2,
        "of the distance from the fitted moment",
        "at which the next moment is weighed, a sample further at least",
        "an end is then known to a tenth of its distance",
    )
    far_chi2: float = criterion(
        49.0,
        "chi2, of the noise that moves numbers",
        "a response so far from the fitted one ends the moments that are weighed",
        "theory: noise of two sqrt(49) would have to take 49 less 7, three standard deviations",
    )
    draws: int = criterion(
        2000, "draws", "of noise, by which the limit of the cost is found", "0.5 % of the share"
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
    first_step_share: float = criterion(
        0.05,
        "of the usual size of a number",
        "first step, at least, on the way to the ends of a number that is not fitted",
        "doubled at each of the looks but one it comes to 3.2 times that size",
    )
    block_s: float = criterion(
        2.0,
        "s",
        "within which the error of a model moves a number in one direction",
        "a zone answers within seconds; a minute has 30 of them, enough for a variance",
    )
    ranges: RangeCriteria = field(default_factory=RangeCriteria)
    moments: MomentCriteria = field(default_factory=MomentCriteria)
    above_noise: float = criterion(
        1.1, "after over floor", "a channel from this ratio on holds more than noise", NOT_RECORDED
    )
    missed_power: float = criterion(
        1.0,
        "of the power of noise, in one tension of the record judged",
        "an amended line that leaves as much beyond noise does not fit: only its effects are told",
        "as judge.least_power, 1.41 of the noise's rms: of 15 verdicts on simulated lines 13 left "
        "1.0 to 1.3, and two whose numbers were plainly wrong 2.5 and 3.1",
    )
    outside_tolerance: float = criterion(
        1.5,
        "of a tolerance",
        "a declared number is told as outside from here on",
        "theory: a tolerance is two standard deviations, so of 60 numbers chance takes three "
        "beyond it, and beyond 1.5 of it one in six verdicts",
    )
    named_numbers: int = criterion(
        3,
        "declared numbers",
        "outside are named each; more of them say that the explanation is incomplete",
        "decision: each is an order to measure something",
    )
    near_step_s: float = criterion(
        0.5,
        "s",
        "a moment this close to a step of a reference is told as falling on it",
        "theory: drives answer within a tenth of a second, a tension loop within half a second",
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
    start_points: int = criterion(
        1024, "angles per turn", "at which the moment arm of a start shape is taken", NOT_RECORDED
    )
