"""What to do at the machine, or in the declaration, about an effect that was traced."""

from __future__ import annotations

_TABLE = """
out_of_round_roll: look how {place} was stored and clamped; the next roll brings a shape of its own
eccentric_roller: put a dial gauge on {place} and have the roller, or its bearing seats, trued
unbalanced_roller: have {place} balanced
unbalanced_measuring_roller: have the measuring roller {place} balanced
bearing_drag: turn {place} by hand with the web off; clean, grease or change its bearings
web_modulus: measure the stiffness of the web and put web.EA_N of the declaration right
viscoelastic_web: keep to the amended line; this web creeps, no setting is wrong
wound_in_strain: ask how tight the roll was wound and put web.wound_in_tension_N right
thermal_strain: measure the web's temperature before and after {place}
slip: clean the surface of {place}, give it more wrap or nip, or run slower
splice: judge the webs before and after the splice on their own
roll_bounce: look for play in mandrel and chucks of {place}, or avoid the speed at which it rings
load_cell_filter: compare the filter set in the amplifier of {place} with low_pass_Hz as declared
load_cell_resonance: look for loose mounts at {place}
load_cell_calibration: calibrate {place} with a known weight
mains_hum: look at shield and earth of the cable of {place}
shaft_compliance_backlash: look for play in couplings, keys and gear of {place}
torque_ripple: look at the commutation and the encoder offset of the motor of {place}
loop_delay: look for what is slow between load cell and drive {place}: task period, bus, filters
rate_limit: let the tension correction enter behind the ramp of drive {place}
radius_error: put radius or gear ratio in drive {place} right
encoder_eccentricity: centre the encoder of {place} and its coupling
"""
REMEDIES = dict(row.split(": ", 1) for row in _TABLE.strip().splitlines())
"""Effect -> what to do; ``{place}`` stands for where."""


def remedy(effect: str, place: str) -> str:
    """Return what to do about an effect at ``place``, without a stop at its end."""
    return REMEDIES.get(effect, "put the machine, or its declaration, right").format(place=place)
