"""Criteria of general effects: what explains an output without a line declaration."""

from __future__ import annotations

from dataclasses import dataclass

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
    halves: tuple[int, ...] = criterion(
        (1, 2, 4, 10),
        "samples",
        "on either side of the shorter filters that are tried beside the plain one",
        NOT_RECORDED,
    )
    shortest_causal_back: int = criterion(
        3,
        "samples",
        "a causal filter that is tried reaches back by as many at least",
        "decision: a shorter one is part of the centred filter with one or two taps more",
    )
    plain_half: int = criterion(
        20,
        "samples",
        "on either side in a plain least-squares filter",
        "41 taps centred on the sample",
    )
    past_orders: tuple[int, ...] = criterion(
        (1, 2, 5, 10, 20, 40), "samples", "of past outputs that are tried", NOT_RECORDED
    )
    fit_steps: int = criterion(5, "Gauss-Newton steps", "of a fit at most", NOT_RECORDED)
    step_halvings: int = criterion(
        6, "lengths", "of such a step that are tried, each half the one before", NOT_RECORDED
    )
    own_shift_steps: int = criterion(
        4, "Gauss-Newton steps", "to a record's own shift", NOT_RECORDED
    )
    most_shift_samples: float = criterion(
        2.0, "samples", "by so much one of these moves the shift at most", NOT_RECORDED
    )
    slope_share: float = criterion(
        1e-3,
        "of a number",
        "step by which a slope is taken of it",
        "theory: the slope is off by as much, and rounding is 1e-13 of it",
    )
    slope_least_share: float = criterion(
        0.1,
        "of the largest number of its effect",
        "as large a number counts at least where its slope is taken",
        "one near 0 has a step too; numbers of an effect are made of one size",
    )
    least_gain_share: float = criterion(
        1e-6,
        "of the weighted squares",
        "a step that gains less ends the fit",
        "theory: of 10 000 rows 0.01, far below what any effect has to gain",
    )
    slope_samples: float = criterion(
        0.05, "samples", "by so much a shift or a delay is moved to find its slope", NOT_RECORDED
    )
    backlash_starts: tuple[float, ...] = criterion(
        (0.1, 0.3, 0.8, 1.6),
        "of the input's standard deviation",
        "plays that a fit starts from",
        NOT_RECORDED,
    )
    dead_band_starts: tuple[float, ...] = criterion(
        (0.1, 0.25, 0.5, 0.7),
        "of the readings",
        "lie within the half widths that a fit starts from",
        NOT_RECORDED,
    )
    saturation_starts: tuple[float, ...] = criterion(
        (0.5, 0.7, 0.85, 0.95),
        "of the readings",
        "lie within the limits that a fit starts from",
        NOT_RECORDED,
    )
    gain_starts: tuple[float, ...] = criterion(
        (-0.3, 0.3),
        "of the gain, per standard deviation of the state",
        "changes of the gain that a fit starts from",
        NOT_RECORDED,
    )
    curve_starts: tuple[float, ...] = criterion(
        (-0.3, -0.1, 0.1, 0.3),
        "of the input at its rms",
        "changes of the input by the curves that a fit starts from",
        "a weak and a strong bend of either sign",
    )
