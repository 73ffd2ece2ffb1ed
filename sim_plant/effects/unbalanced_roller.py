"""A body whose centre of gravity is off its axis while its surface runs true."""

from __future__ import annotations

import cmath
from collections.abc import Mapping

from sim_plant.base.arrays import LineArrays
from sim_plant.base.effects import Effect, Quadrature, Value
from sim_plant.base.signatures import whole
from sim_plant.effects.phasor import amplitude, angle, component, phasor
from sim_plant.effects.shape_rows import add_gravity_moment

GRAVITY_M_S2 = 9.80665
PAIR = Quadrature(cos="cos_kg_m", sin="sin_kg_m", amplitude="unbalance_kg_m", angle="angle_rad")


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Add the gravity torque -sigma m g e cos(gamma) to body ``place`` [source 3.17 corrected]."""
    unbalance_kg_m = phasor(parameters, PAIR)
    if unbalance_kg_m != 0.0:
        gravity_moment_N_m = abs(unbalance_kg_m) * GRAVITY_M_S2
        add_gravity_moment(arrays, place, gravity_moment_N_m, cmath.phase(unbalance_kg_m))
    return arrays


def among(places: str) -> str:
    """Return what tells which of several bodies is out of balance."""
    return (
        f"take the web off and let {places} turn freely, several times: the one that is out of "
        "balance comes to rest with the same side down"
    )


EFFECT = Effect(
    name="unbalanced_roller",
    place="body",
    candidates="turning",
    accepts={
        "unbalance_kg_m": amplitude("kg m", 2e-3, 2.0),
        "angle_rad": angle(),
        "cos_kg_m": component("kg m", 2e-3, 2.0),
        "sin_kg_m": component("kg m", 2e-3, 2.0),
    },
    fitted=("cos_kg_m", "sin_kg_m"),
    quadratures=(PAIR,),
    apply=apply,
    text="a body is heavier on one side: a torque once per turn that does not grow with speed",
    shows=whole(1),
    remedy="have {place} balanced",
    among=among,
    cancel_orders=(1,),
)
