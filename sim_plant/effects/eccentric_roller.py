"""A round roller that turns about a point beside its centre."""

from __future__ import annotations

import cmath
from collections.abc import Mapping

from sim_plant.base.arrays import LineArrays
from sim_plant.base.effects import Effect, Parameter, Quadrature, Value
from sim_plant.base.signatures import whole
from sim_plant.effects.phasor import amplitude, angle, component, phasor
from sim_plant.effects.shape_rows import add_gravity_moment, add_shape
from sim_plant.geometry.shapes import eccentric

GRAVITY_M_S2 = 9.80665
PAIR = Quadrature(cos="cos_m", sin="sin_m", amplitude="eccentricity_m", angle="angle_rad")


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Move the centre of body ``place`` by e; its mass, when given, adds a gravity torque.

    h = R + e cos(psi - angle)   [source 3.9, by support function: exact on both spans]
    """
    centre_m = phasor(parameters, PAIR)
    gravity_moment_N_m = float(parameters["mass_kg"]) * GRAVITY_M_S2 * abs(centre_m)
    if gravity_moment_N_m != 0.0:
        add_gravity_moment(arrays, place, gravity_moment_N_m, cmath.phase(centre_m))
    radius_m = float(arrays.bodies["radius_m"][place])
    return add_shape(arrays, place, eccentric(radius_m, abs(centre_m), cmath.phase(centre_m)))


def run_out(parameters: Mapping[str, Value]) -> float:
    """Return what a dial gauge reads from its least to its most over a turn: 2 e."""
    return 2.0 * abs(phasor(parameters, PAIR))


EFFECT = Effect(
    name="eccentric_roller",
    place="body",
    candidates="roller",
    accepts={
        "eccentricity_m": amplitude("m", 2e-4, 5e-3),
        "angle_rad": angle(),
        "cos_m": component("m", 2e-4, 5e-3),
        "sin_m": component("m", 2e-4, 5e-3),
        "mass_kg": Parameter(
            default=0.0, unit="kg", typical=5.0, low=0.0, high=1e4, linear=True, role="shape"
        ),
    },
    fitted=("cos_m", "sin_m"),
    quadratures=(PAIR,),
    apply=apply,
    text="a roller turns off its centre: ripple once per turn in both its spans",
    shows=whole(1),
    remedy="put a dial gauge on {place}: its total reading is twice the eccentricity; then have "
    "the roller, or its bearing seats, trued",
    run_out=run_out,
    cancel_orders=(1,),
)
