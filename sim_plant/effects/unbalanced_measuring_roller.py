"""A load-cell roller out of balance: it shakes its own cell."""

from __future__ import annotations

import cmath
from collections.abc import Mapping

from sim_plant.base.arrays import LineArrays
from sim_plant.base.effects import Effect, Quadrature, Value
from sim_plant.base.signatures import whole
from sim_plant.effects.experiments import of_the_cell
from sim_plant.effects.phasor import amplitude, angle, component, phasor

PAIR = Quadrature(
    cos="cos_kg_m", sin="sin_kg_m", amplitude="unbalance_kg_m", angle="angle_rad", against=True
)


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Add u w^2 cos(theta + angle) to the reading of cell ``place``, the web feels nothing.

    u is the unbalance as the cell reads it: m e / (2 sin(wrap / 2)), since a reading T stands for
    a force 2 T sin(wrap / 2)   [own; centrifugal force in the cell's direction].
    """
    unbalance_kg_m = phasor(parameters, PAIR)
    if unbalance_kg_m != 0.0:
        cell = arrays.cells[place]
        old = cmath.rect(float(cell["unbalance_kg_m"]), float(cell["unbalance_angle_rad"]))
        # u cos(theta - a) in the components' convention
        total = old + unbalance_kg_m.conjugate()
        cell["unbalance_kg_m"], cell["unbalance_angle_rad"] = abs(total), cmath.phase(total)
    return arrays


EFFECT = Effect(
    name="unbalanced_measuring_roller",
    place="cell",
    candidates="cell",
    accepts={
        "unbalance_kg_m": amplitude("kg m", 1e-3, 0.2),
        "angle_rad": angle(),
        "cos_kg_m": component("kg m", 1e-3, 0.2),
        "sin_kg_m": component("kg m", 1e-3, 0.2),
    },
    fitted=("cos_kg_m", "sin_kg_m"),
    quadratures=(PAIR,),
    apply=apply,
    text="a measuring roller shakes its own cell once per turn, as speed squared",
    shows=whole(1),
    remedy="have the measuring roller {place} balanced",
    experiment=of_the_cell,
    name_in_version_1="unbalanced_roller",
    sensor_only=True,
)
