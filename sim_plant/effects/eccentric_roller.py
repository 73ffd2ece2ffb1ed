"""A round roller that turns about a point beside its centre."""

from __future__ import annotations

from collections.abc import Mapping

from sim_plant.base.arrays import LineArrays
from sim_plant.base.effects import Effect, Value
from sim_plant.effects.shape_rows import add_heavy, add_shape
from sim_plant.geometry.shapes import eccentric

GRAVITY_M_S2 = 9.80665


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Move the centre of body ``place`` by e; its mass, when given, adds a gravity torque.

    h = R + e cos(psi - angle)   [source 3.9, by support function: exact on both spans]
    """
    offset, angle = float(parameters["eccentricity_m"]), float(parameters["angle_rad"])
    heavy = float(parameters["mass_kg"]) * GRAVITY_M_S2 * offset
    if heavy != 0.0:
        add_heavy(arrays, place, heavy, angle)
    radius = float(arrays.bodies["radius_m"][place])
    return add_shape(arrays, place, eccentric(radius, offset, angle))


EFFECT = Effect(
    name="eccentric_roller",
    place="body",
    parameters={"eccentricity_m": 0.0, "angle_rad": 0.0, "mass_kg": 0.0},
    apply=apply,
    text="a roller turns off its centre: ripple once per turn in both its spans",
)
