"""Criteria for a run of the service: how its rows become a record, and its line as it was."""

from __future__ import annotations

from dataclasses import dataclass

from sim_plant.refine.criteria.criterion import NOT_RECORDED, criterion


@dataclass(frozen=True, slots=True, kw_only=True)
class RunCriteria:
    """Which rows of a run make a record, what is filled in between them, and what acted."""

    least_read_share: float = criterion(
        0.5,
        "of the rows",
        "a channel with readings in as many, or in fewer, is left out",
        "a majority: most of what stands there was read",
    )
    finer_share: float = criterion(
        0.5,
        "of the scale of a word",
        "readings that come closer to each other are finer than that scale",
        "two readings of a word are one count apart or more; a record's last digit takes off far "
        "less",
    )
    largest_count: float = criterion(
        1e15,
        "counts, or SI",
        "a row with a larger count or reading shows nothing",
        "theory: doubles count by one up to 9e15",
    )
    shortest_period_s: float = criterion(
        1e-6, "s", "a shorter scan or cycle is refused", "no PLC scans so often"
    )
    late_s: float = criterion(
        0.25,
        "s",
        "a heartbeat further off the run's clock, from one row to the next, is a break, and does "
        "not agree with a count; rows further apart give no period of the scan",
        NOT_RECORDED,
    )
    most_scans: float = criterion(
        500.0,
        "scans",
        "between two rows; a larger step of the heartbeat is no count of scans",
        NOT_RECORDED,
    )
    same_period_share: float = criterion(
        1e-4,
        "1",
        "a scan period this close to a whole number of cycles is that number; where the rows tell "
        "it less surely, their own error counts",
        "the clocks of PLC and gateway differ by as much",
    )
    near_period_share: float = criterion(
        0.01,
        "1",
        "readings of a PLC whose period is its own, but this close to a whole number of cycles, "
        "are put on a grid of that many",
        NOT_RECORDED,
    )
    filled_samples: int = criterion(
        4, "samples", "that are missing are filled in between neighbours", NOT_RECORDED
    )
    beyond_filled: float = criterion(
        1.5,
        "samples",
        "from one reading to the next, more than those filled in: a longer hole ends a piece",
        "from reading to reading is a step more than are missing; half a step for stamps that "
        "wander",
    )
    same_scan_share: float = criterion(
        1e-3, "of a scan", "stamps this close are of the same scan", NOT_RECORDED
    )
    usual_cycles: int = criterion(
        2,
        "cycles",
        "from a snapshot to the scan whose output has its correction, where no one says it",
        "sent one tick later, and then the scan after that takes it",
    )
    shortest_piece_s: float = criterion(
        20.0,
        "s",
        "a shorter piece is refused",
        "its first quarter is not judged (noise.settling_share), so 15 s are left: some 8 turns "
        "of a roll of 0.6 m diameter at 1 m/s",
    )
    most_unknown_s: float = criterion(
        1.0,
        "s",
        "a piece may be shorter by as much where it is not known what acted at its begin",
        "the time from a row to the drive, some cycles; so a window of just 20 s is not refused",
    )
    ramp_look_s: float = criterion(
        1.0,
        "s",
        "over which a mean speed and its change are taken; so far a ramp reaches beyond its ends",
        NOT_RECORDED,
    )
    ramp_share: float = criterion(
        0.01,
        "of the highest speed",
        "a mean speed that changes by more within ramp_look_s is a ramp",
        NOT_RECORDED,
    )
    limited_share: float = criterion(
        0.999, "of a correction", "where a smaller share goes out a limit cuts it", NOT_RECORDED
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class RunLineCriteria:
    """What a run's line was like: radii at its begin, and a speed reference that it lacks."""

    start_s: float = criterion(
        1.0,
        "s",
        "of a recorded radius; a line through them gives its start where no angle is recorded",
        NOT_RECORDED,
    )
    turning_s: float = criterion(
        10.0,
        "s",
        "of a roll's turning, from which its radius comes where none is recorded",
        NOT_RECORDED,
    )
    largest_cores: float = criterion(
        50.0, "radii of the core", "no roll is that large", NOT_RECORDED
    )
    other_share: float = criterion(
        0.1,
        "1",
        "a body that turns this much off what its radius makes it is none of the line",
        "a draw is some 0.001, a radius that is roughly known 0.01; a run's units are its own "
        "site file's",
    )
    least_web_m: float = criterion(
        1.0, "m", "of web have to run before a radius is told from them", NOT_RECORDED
    )
    least_turn_rad: float = criterion(
        1.0, "rad", "a body has to turn before a radius is told from it", NOT_RECORDED
    )
    smoothed_s: float = criterion(
        0.1,
        "s",
        "to either side, over which a measured speed is smoothed that no straight ramp fits",
        NOT_RECORDED,
    )
    shortest_rest_s: float = criterion(
        2.0, "s", "the mean of a speed that rests for less is no level", NOT_RECORDED
    )
    rest_margin_s: float = criterion(
        0.8, "s", "to either side of a change, before the speed is taken to rest", NOT_RECORDED
    )
    straight_share: float = criterion(
        0.01,
        "of the speed",
        "a ramp that is nearer to what was measured is straight; levels that differ by less have "
        "no ramp between them",
        NOT_RECORDED,
    )
    ramp_lengths: int = criterion(200, "lengths", "of a ramp that are tried", NOT_RECORDED)
