"""The catalogue of general effects: one row each, in the order in which they are tried."""

from __future__ import annotations

from sim_plant.refine.without_line.general import (
    backlash,
    channel_shift,
    dead_band,
    filter_length,
    friction_by_sign,
    friction_by_speed,
    offset_drift,
    past_outputs,
    saturation,
    state_dependence,
    static_nonlinearity,
)

CATALOGUE = (
    filter_length.EFFECT,
    channel_shift.EFFECT,
    offset_drift.EFFECT,
    friction_by_sign.EFFECT,
    friction_by_speed.EFFECT,
    dead_band.EFFECT,
    saturation.EFFECT,
    backlash.EFFECT,
    static_nonlinearity.EFFECT,
    state_dependence.EFFECT,
    past_outputs.EFFECT,
)
BY_NAME = {effect.name: effect for effect in CATALOGUE}
FILTER, SHIFT, OWN, PAST = (
    module.EFFECT.name for module in (filter_length, channel_shift, offset_drift, past_outputs)
)
"""Names of those that are no term of a model: its lags, shifts, zero and drift, past outputs."""
