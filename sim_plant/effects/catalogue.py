"""Every effect, one row each; a new effect is one file, one row here, one test."""

from __future__ import annotations

from sim_plant.base.effects import Effect
from sim_plant.effects import (
    bearing_drag,
    changed_number,
    eccentric_roller,
    encoder_eccentricity,
    load_cell_calibration,
    load_cell_filter,
    load_cell_resonance,
    loop_delay,
    mains_hum,
    nip_pulse,
    out_of_round_roll,
    radius_error,
    rate_limit,
    roll_bounce,
    shaft_compliance_backlash,
    slip,
    splice,
    thermal_strain,
    torque_ripple,
    unbalanced_measuring_roller,
    unbalanced_roller,
    viscoelastic_web,
    web_modulus,
    wound_in_strain,
)

CATALOGUE: tuple[Effect, ...] = (
    out_of_round_roll.EFFECT,
    eccentric_roller.EFFECT,
    unbalanced_roller.EFFECT,
    unbalanced_measuring_roller.EFFECT,
    bearing_drag.EFFECT,
    web_modulus.EFFECT,
    viscoelastic_web.EFFECT,
    wound_in_strain.EFFECT,
    thermal_strain.EFFECT,
    slip.EFFECT,
    splice.EFFECT,
    roll_bounce.EFFECT,
    load_cell_filter.EFFECT,
    load_cell_resonance.EFFECT,
    load_cell_calibration.EFFECT,
    mains_hum.EFFECT,
    shaft_compliance_backlash.EFFECT,
    torque_ripple.EFFECT,
    nip_pulse.EFFECT,
    loop_delay.EFFECT,
    rate_limit.EFFECT,
    radius_error.EFFECT,
    encoder_eccentricity.EFFECT,
    changed_number.EFFECT,
)
BY_NAME = {effect.name: effect for effect in CATALOGUE}
