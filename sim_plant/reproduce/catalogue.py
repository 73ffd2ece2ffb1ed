"""Every experiment, chapter by chapter; a new one is one file and one row here."""

from __future__ import annotations

from sim_plant.reproduce.entry import Experiment
from sim_plant.reproduce.experiments import (
    angle_error,
    convex_roll,
    dancers,
    distortion,
    eccentric_swrap,
    ellipse_span,
    flow_errors,
    flow_simulations,
    high_speed,
    identification,
    roll_feed_forward,
    sampling_period,
    span_length,
    spectra,
    swrap_feed_forward,
    tension_steps,
    warm_span,
    wooden_insert,
    wound_roll,
)

CATALOGUE: tuple[Experiment, ...] = (
    *distortion.EXPERIMENTS,
    *identification.EXPERIMENTS,
    *tension_steps.EXPERIMENTS,
    *spectra.EXPERIMENTS,
    *span_length.EXPERIMENTS,
    *eccentric_swrap.EXPERIMENTS,
    *ellipse_span.EXPERIMENTS,
    *convex_roll.EXPERIMENTS,
    *wound_roll.EXPERIMENTS,
    *wooden_insert.EXPERIMENTS,
    *flow_simulations.EXPERIMENTS,
    *flow_errors.EXPERIMENTS,
    *angle_error.EXPERIMENTS,
    *swrap_feed_forward.EXPERIMENTS,
    *roll_feed_forward.EXPERIMENTS,
    *dancers.EXPERIMENTS,
    *warm_span.EXPERIMENTS,
    *sampling_period.EXPERIMENTS,
    *high_speed.EXPERIMENTS,
)
BY_IDENTITY = {experiment.identity: experiment for experiment in CATALOGUE}
