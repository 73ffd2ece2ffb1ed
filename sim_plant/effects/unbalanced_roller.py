"""A body whose centre of gravity is off its axis while its surface runs true."""

from __future__ import annotations

from collections.abc import Mapping

from sim_plant.base.arrays import LineArrays
from sim_plant.base.effects import Effect, Value
from sim_plant.effects.shape_rows import add_heavy

GRAVITY_M_S2 = 9.80665


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Add the gravity torque -sigma m g e cos(gamma) to body ``place`` [source 3.17 corrected]."""
    heavy = float(parameters["unbalance_kg_m"]) * GRAVITY_M_S2
    if heavy != 0.0:
        add_heavy(arrays, place, heavy, float(parameters["angle_rad"]))
    return arrays


EFFECT = Effect(
    name="unbalanced_roller",
    place="body",
    parameters={"unbalance_kg_m": 0.0, "angle_rad": 0.0},
    apply=apply,
    text="a body is heavier on one side: a torque once per turn that does not grow with speed",
)
