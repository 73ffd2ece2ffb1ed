"""A bearing that turns hard."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from sim_plant.base.arrays import DRAG, LineArrays
from sim_plant.base.effects import DeclaredNumber, Effect, Parameter, Value
from sim_plant.effects.onset import FROM, HOLD, begins, begins_later, with_change


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Add friction torque c tanh(w / 0.3 rad/s) + b w to body ``place``   [source 2.32, 2.44].

    At rest T_down - T_up = torque / R across an idler [source 2.34 with the sign of 2.9]. With
    ``from_s`` the constant part is there from a moment of the record on, for ``hold_s``.
    """
    body = arrays.bodies[place]
    constant_N_m = float(parameters["constant_N_m"])
    if begins_later(parameters):
        arrays = with_change(arrays, DRAG, place, constant_N_m, parameters)
    else:
        body["friction_constant_N_m"] += constant_N_m
    body["friction_viscous_N_m_s"] += float(parameters["viscous_N_m_s"])
    return arrays


def bounds(arrays: LineArrays, place: int) -> dict[str, tuple[float, float]]:
    """Return 0..T R: web at tension T cannot drag a harder bearing round, it slips.

    T is the tension the roll was wound at. A bearing easier than declared is a tolerance of the
    declared friction, not this effect.
    """
    tension_N = float(arrays.web["supply_strain"][0]) * float(np.max(arrays.spans["EA_N"]))
    most = tension_N * float(arrays.bodies["radius_m"][place])
    return {"constant_N_m": (0.0, most)} if most > 0.0 else {}


def share(arrays: LineArrays, place: int) -> float:
    """Return the change of the declared friction per N m, a share of it; inf where it has none."""
    declared_N_m = float(arrays.bodies["friction_constant_N_m"][place])
    return 1.0 / declared_N_m if declared_N_m > 0.0 else math.inf


def among(places: str) -> str:
    """Return what tells which of several bearings drags."""
    return (
        f"take the web off, spin {places} by hand and time how long each coasts: the one that "
        "stops first drags (compare like idlers only)"
    )


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
        "from_s": FROM,
        "hold_s": HOLD,
    },
    fitted=("constant_N_m",),
    apply=apply,
    bounds=bounds,
    text="a bearing turns harder than declared: tension steps across the roller",
    shows=None,
    onset=begins("constant_N_m"),
    remedy="turn {place} by hand with the web off; clean, grease or change its bearings",
    among=among,
    declared_as=(
        DeclaredNumber(
            number="rollers.{place}.friction_constant_N_m", parameter="constant_N_m", scale=share
        ),
    ),
)
