"""A bearing that turns hard."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sim_plant.base.arrays import LineArrays
from sim_plant.base.effects import Effect, Parameter, Value


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Add friction torque c tanh(w / 0.3 rad/s) + b w to body ``place``   [source 2.32, 2.44].

    At rest T_down - T_up = torque / R across an idler [source 2.34 with the sign of 2.9].
    """
    body = arrays.bodies[place]
    body["friction_constant_N_m"] += float(parameters["constant_N_m"])
    body["friction_viscous_N_m_s"] += float(parameters["viscous_N_m_s"])
    return arrays


def limits(arrays: LineArrays, place: int) -> dict[str, tuple[float, float]]:
    """Return 0..T R: web at tension T cannot drag a harder bearing round, it slips.

    T is the tension the roll was wound at. A bearing easier than declared is a tolerance of the
    declared friction, not this effect.
    """
    tension_N = float(arrays.web["supply_strain"][0]) * float(np.max(arrays.spans["EA_N"]))
    most = tension_N * float(arrays.bodies["radius_m"][place])
    return {"constant_N_m": (0.0, most)} if most > 0.0 else {}


EFFECT = Effect(
    name="bearing_drag",
    place="body",
    candidates="turning",
    accepts={
        "constant_N_m": Parameter(
            default=0.0, unit="N m", typical=0.05, low=0.0, high=20.0, linear=True
        ),
        "viscous_N_m_s": Parameter(
            default=0.0, unit="N m s", typical=0.001, low=0.0, high=2.0, linear=True
        ),
    },
    traced=("constant_N_m", "viscous_N_m_s"),
    apply=apply,
    limits=limits,
    text="a bearing turns hard: tension steps across the roller, with a slope over speed",
)
