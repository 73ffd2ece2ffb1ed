"""Criteria for weighing and fitting: noise, free spectral lines, the objective and its fit."""

from __future__ import annotations

from dataclasses import dataclass, field

from sim_plant.refine.criteria.criterion import NOT_RECORDED, criterion
from sim_plant.refine.criteria.start_angles import StartAngleCriteria


@dataclass(frozen=True, slots=True, kw_only=True)
class NoiseCriteria:
    """How the noise of channels is modelled, and what of a residual may be noise."""

    settling_s: float = criterion(
        20.0,
        "s",
        "a record is judged from here on, a short one after its first quarter",
        "the start state of a record is unknown; a pull-roll zone settles in about 10 s",
    )
    settling_share: float = criterion(
        0.25, "1", "share of a short record, from its start, that is not judged", NOT_RECORDED
    )
    bands: tuple[float, ...] = criterion(
        (0.0, 1.0 / 16.0, 1.0 / 8.0, 1.0 / 4.0, 1.0 / 2.0, 3.0 / 4.0, 1.0),
        "of half the sample rate",
        "edges of the bands in which data are compared with the declared noise",
        NOT_RECORDED,
    )
    whitening_taps: int = criterion(
        24,
        "taps",
        "of the filter that makes declared noise white, at 10 ms and slower; faster: whitening_s",
        NOT_RECORDED,
    )
    whitening_s: float = criterion(
        0.24,
        "s",
        "the filter spans no less, whatever the sample time",
        "24 taps of 10 ms: noise is slow by the line's loops and zones, not by samples",
    )
    colour_taps: int = criterion(
        12, "taps", "of the filter that puts the colour of declared noise right", NOT_RECORDED
    )
    rounded_share: float = criterion(
        0.5,
        "of a channel's noise power",
        "rounding above which a channel is one of coarse words",
        "a majority: the rounding is most of what is there",
    )
    calm_share: float = criterion(
        0.75,
        "of the bins of a band",
        "the quietest bins, from which the level of a band is taken",
        "spectral lines of rollers take up fewer than the rest",
    )
    upper_bands: int = criterion(
        2,
        "bands",
        "the uppermost, whose level bounds that of all others",
        "effects of rollers do not reach there",
    )
    quietest: float = criterion(
        0.6, "of the declared power", "a band is taken for no quieter", NOT_RECORDED
    )
    loudest: float = criterion(
        1.5, "of the power of the upper bands", "a band is taken for no louder", NOT_RECORDED
    )
    white_shares: tuple[float, ...] = criterion(
        (0.0, 0.5, 0.8, 0.95),
        "of the power",
        "shares of a word's rounding sawtooth that may be white; the data choose one",
        "late scans break the sawtooth up",
    )
    coarse_word_factor: float = criterion(
        8.0,
        "of the rms of its step",
        "innovation sd of a word whose error is a slow sawtooth: one row counts per step passed",
        NOT_RECORDED,
    )
    same_ratio: float = criterion(
        1e-3,
        "1",
        "a ratio of two steps of words this close to a whole number is that number",
        "scales are written with few digits",
    )
    drift_terms: int = criterion(
        32,
        "cosines",
        "the slowest of a record, whose level is looked at; a record longer than ``drift_s`` has "
        "more",
        NOT_RECORDED,
    )
    drift_s: float = criterion(
        60.0,
        "s",
        "judged time from which on more cosines than ``drift_terms`` are looked at",
        "that of a record of 80 s",
    )
    drift_Hz: float = criterion(
        0.4,
        "Hz",
        "frequency at which the cosines end that a longer record has more",
        "where 32 of 40 s end; white noise with 0.3 of its sd in 3 s drift kept 2.7 of its power "
        "at 0.03 to 0.1 Hz in 10 min, 0.96 with more of them",
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class SpectraCriteria:
    """Where free spectral lines are looked for, and which count as the same one."""

    fewest_cycles: float = criterion(
        3.0, "cycles per record", "a slower spectral line is not looked for", NOT_RECORDED
    )
    alias_cycles: float = criterion(
        8.0,
        "cycles per record",
        "a slower spectral line is no alias of a known frequency",
        "mains wander by 0.05 Hz, their harmonics by more: an alias is not that slow; "
        "a ramp or two in a minute have spectral lines below",
    )
    nyquist_share: float = criterion(
        0.98,
        "of half the sample rate",
        "a faster spectral line in travel, or at a roll's angle, is not looked for",
        NOT_RECORDED,
    )
    least_travel_m: float = criterion(
        1.0, "m", "spectral lines in travel are looked for over more of it", NOT_RECORDED
    )
    fewest_turns: float = criterion(
        6.0, "turns", "spectral lines at a roll's angle are looked for over more", NOT_RECORDED
    )
    highest_order: float = criterion(
        16.0,
        "per turn",
        "spectral lines at a roll's angle are looked for at least up to it",
        "samples of 50 ms hold order 8 but for the fastest turns: elsewhere it shows",
    )
    same_coordinate_share: float = criterion(
        0.006,
        "1",
        "coordinates closer than this, relative, are one spectral line",
        "what a record of a minute resolves",
    )
    same_frequency_share: float = criterion(
        0.003, "1", "the same for a spectral line in time at a known frequency", NOT_RECORDED
    )
    half_widths: float = criterion(
        2.0,
        "half widths of a resonance",
        "a search begins no further from the frequency at which it rings",
        "theory: two resonances of one damping so far apart have a correlation of 0.71 (2 g / "
        "sqrt(4 g^2 + d^2) of half width g and distance d), so a first look explains half",
    )
    whole_order_reach: float = criterion(
        0.1,
        "of an order",
        "a spectral line further off a whole order proposes none",
        "spectral lines of other rollers lie anywhere between whole orders",
    )
    least_speed_spread: float = criterion(
        1e-3,
        "of the mean speed",
        "a speed that spreads less: no spectral line is free to grow with speed",
        NOT_RECORDED,
    )
    fewest_cells: float = criterion(
        16.0,
        "cells",
        "of the grid of a spectrum, at least",
        "theory: they reach four cycles per record, and the slowest looked for has three",
    )
    cells_per_cycle: int = criterion(
        8,
        "cells",
        "of the grid of a spectrum, at least, per cycle of its highest frequency",
        "theory: binning takes at most 5 % of a chi2 there, 1 - sinc(1/8)^2",
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class FitCriteria:
    """Which numbers a fit moves, how far, and when it ends."""

    noise_runs: int = criterion(
        12, "runs", "noise realisations from which filters are made", NOT_RECORDED
    )
    coarse_power: float = criterion(
        1.5,
        "of the power that is expected",
        "what a channel of coarse words leaves up to this counts as noise",
        "steps nearly in time with the samples: local power is 0.7 to 2.0 of the mean",
    )
    free_orders: int = criterion(
        12,
        "orders of the roll",
        "orders of a traced shape that stay free: a further effect must explain more than them",
        NOT_RECORDED,
    )
    simulated_norm: float = criterion(
        30.0,
        "norm of the whitened residual",
        "a nuisance whose shift moves the residual by more is simulated, not linear",
        NOT_RECORDED,
    )
    start_tension_share: float = criterion(
        0.1,
        "of the tension",
        "how far from rest the start state of a run may be, in torques of drives and in the web; "
        "a part of it that shows by less than noise is not estimated",
        "a probe and a step of tension leave some 0.02 in the drives of an S-wrap (ADR 0038)",
    )
    astray_sd: float = criterion(
        50.0,
        "prior standard deviations",
        "a step that moves a declared number by more is not tried",
        "that far no slope holds, and such a line is slow to simulate or none at all",
    )
    free_number: float = criterion(
        1000.0,
        "of its tolerance",
        "by which a declared number may move that is surely beyond it",
        "numbers of that kind were 17 to 126 standard deviations off: that then costs less than "
        "0.02",
    )
    least_gain: float = criterion(
        1.0,
        "chi2",
        "a step that gains less than this, or the share below, ends the fit",
        NOT_RECORDED,
    )
    least_gain_share: float = criterion(
        1e-4, "of the cost", "so does one that gains less than this", NOT_RECORDED
    )
    in_step_rad: float = criterion(
        0.02,
        "rad over the record",
        "a simulated roll closer to the measured one is in step",
        NOT_RECORDED,
    )
    step_shares: tuple[float, ...] = criterion(
        (1.0, 0.4, 0.15, 0.05),
        "of a Gauss-Newton step",
        "are tried in turn until the cost falls",
        NOT_RECORDED,
    )
    ripple_m: float = criterion(
        2e-5,
        "m",
        "order 1 of the ripple by which a free shape's change is taken; order n has 1/n",
        "orders are free in size: it decides only how far the line is from straight in it",
    )
    in_step_rounds: int = criterion(
        4,
        "simulations",
        "that bring rolls into step, each from the radii that the one before asks for",
        NOT_RECORDED,
    )
    rounds: int = criterion(
        6,
        "Gauss-Newton steps",
        "at most, of a fit from the numbers of a first look",
        "theory: the error of a step goes with the square of that before, so three do from a "
        "tenth off; where a step is shortened it takes as many again",
    )
    rounds_near: int = criterion(
        4,
        "Gauss-Newton steps",
        "at most, of a fit from numbers that were fitted already",
        "theory: as from a first look, but two steps nearer",
    )
    rounds_again: int = criterion(
        3,
        "Gauss-Newton steps",
        "at most, of a fit of declared numbers alone, or of one with slopes taken anew",
        "theory: tolerances are percents, of which two steps leave nothing; the third shows it",
    )
    start_angles: StartAngleCriteria = field(default_factory=StartAngleCriteria)
