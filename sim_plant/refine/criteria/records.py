"""Criteria for what is read: whether it is a record, and whether it belongs to this line."""

from __future__ import annotations

from dataclasses import dataclass, field

from sim_plant.refine.criteria.criterion import NOT_RECORDED, criterion
from sim_plant.refine.criteria.runs import RunCriteria


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordCriteria:
    """Whether a file is a record, and what of it is reported as odd."""

    largest_reading: float = criterion(
        1e30,
        "SI",
        "a reading beyond this is refused",
        "no sensor reads more in any SI unit; its square still is a number",
    )
    fewest_rows: int = criterion(100, "rows", "a shorter record is refused", NOT_RECORDED)
    most_pieces: int = criterion(
        8,
        "pieces",
        "of one window with more the longest are taken as records",
        "an hour with a splice every 8 min; time and memory of a search go with the rows",
    )
    longest_gap_samples: float = criterion(
        1.7, "sample times", "a longer step between stamps is a gap, refused", NOT_RECORDED
    )
    misplaced_stamp_share: float = criterion(
        0.2,
        "sample times",
        "an odd step between stamps is one misplaced stamp where it and its neighbour add up to "
        "two sample times to within this",
        NOT_RECORDED,
    )
    jitter_share: float = criterion(
        0.02,
        "sample times",
        "stamps off an even grid by more are put on one, and that is reported",
        NOT_RECORDED,
    )
    coarse_levels_share: float = criterion(
        0.2,
        "levels per row",
        "a column with fewer levels is reported as read in steps",
        NOT_RECORDED,
    )
    stuck_share: float = criterion(
        0.05,
        "of the rows",
        "a column that stands at one end of its range for more is reported as stuck",
        NOT_RECORDED,
    )
    stuck_levels: int = criterion(
        20, "levels", "a column of no more levels is not reported as stuck", NOT_RECORDED
    )
    turning_steps: int = criterion(
        21,
        "steps",
        "around a step of an angle, whose median says how fast its roll turns there",
        "0.1 s at 5 ms: with a quarter of them starts over the median is of the others",
    )
    counter_wrap_rad: float = criterion(
        0.3,
        "rad",
        "an angle that is off the expected one by whole starts over to within this, and its own "
        "scatter, has started over",
        "a speed that is wrong by 2 % over 5.5 steps of 2 rad is off by 0.22 rad; of counts that "
        "begin anew anywhere a tenth is that close to a whole turn",
    )
    scatter_share: float = criterion(
        0.99,
        "of the steps without a start over",
        "the largest deviation of these is the scatter of an angle",
        "of a hundred steps one may be a late reading, or a start over that was not told",
    )
    usual_step: float = criterion(
        1.5,
        "of the median step of time",
        "a longer one is a hole and tells no speed",
        "theory: with one reading missing it is 2; half way there",
    )
    counter_wrap_scatter: float = criterion(
        4.0,
        "1",
        "times the scatter (99 % of the steps without a start over) is added to that",
        "a drive that reads its encoder by a clock of its own is off by one of its cycles, over "
        "a hole too; four times that has room for both ends",
    )
    spike_sigma: float = criterion(
        12.0,
        "robust standard deviations",
        "a sample further off the median of its 7 neighbours is reported as a spike",
        NOT_RECORDED,
    )
    spike_samples: int = criterion(
        7,
        "samples",
        "whose median a sample is compared with",
        "theory: a median of 7 is not moved by 3 spikes, and leaves a ramp as it is",
    )
    spike_counts: float = criterion(
        1.5,
        "counts of a coarse word",
        "a sample that is off by less is no spike",
        "theory: a word trembles by one count; half way to two",
    )
    run: RunCriteria = field(default_factory=RunCriteria)


@dataclass(frozen=True, slots=True, kw_only=True)
class MatchCriteria:
    """Whether a record belongs to a line; refused where not."""

    sample_time_share: float = criterion(
        1e-3, "1", "sample times of record and line differ by no more", NOT_RECORDED
    )
    speed_mismatch: float = criterion(
        0.2,
        "1",
        "a web speed is within this share of the reference; angles and speeds of rolls, whose "
        "radius may be another, within twice that",
        NOT_RECORDED,
    )
    tension_ratio: tuple[float, float] = criterion(
        (0.3, 3.3),
        "1",
        "median of a tension over that of its reference",
        "narrower than a pound taken for a newton, either way",
    )
    highest_strain: float = criterion(
        0.2, "1", "no tension strains the declared web by more", NOT_RECORDED
    )
    radius_share: float = criterion(
        0.02, "1", "a roll radius begins within this share of the declared one", NOT_RECORDED
    )
    running_speed_share: float = criterion(
        0.1, "of the fastest speed", "the line counts as running where it is faster", NOT_RECORDED
    )
    least_running_share: float = criterion(
        0.1, "of the rows", "a line that runs in fewer does not run enough", NOT_RECORDED
    )
    one_speed_share: float = criterion(
        0.02,
        "1",
        "a speed that changes by less of its mean is reported as one speed only",
        NOT_RECORDED,
    )
