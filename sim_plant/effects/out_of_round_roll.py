"""A roll that is not round: its moment arm varies with its angle, and so may its balance."""

from __future__ import annotations

import cmath
from collections.abc import Mapping

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import REWIND, UNWIND, LineArrays
from sim_plant.base.effects import Effect, Value
from sim_plant.effects.shape_rows import add_heavy, add_shape
from sim_plant.geometry.roll_profiles import asymmetric, bulge, flat_spot, flattened_bulge
from sim_plant.geometry.shapes import Shape, circle, ellipse, orders
from sim_plant.geometry.wound_mass import wound_mass

GRAVITY_M_S2 = 9.80665
KINDS = ("flat", "bulge", "asym", "flattened_bulge", "ellipse", "orders")


def shape_of(kind: str, size_m: float, radius_m: float, angle_rad: float) -> Shape:
    """Return the named profile round ``radius_m``; size is depth, height or half axis spread."""
    if size_m == 0.0:
        return circle(radius_m)
    if kind == "flat":
        return flat_spot(size_m, radius_m, angle_rad)
    if kind == "bulge":
        return bulge(size_m, radius_m, angle_rad)
    if kind == "asym":
        return asymmetric(size_m, radius_m, angle_rad)
    if kind == "flattened_bulge":
        return flattened_bulge(size_m, 6.0 * size_m, radius_m, angle_rad)
    if kind == "ellipse":
        return ellipse(radius_m + size_m, radius_m - size_m).turned(angle_rad)
    raise PlantError(f"out_of_round_roll.shape: read {kind!r}; expected one of {KINDS}")


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Give body ``place`` the profile, on a roll also the gravity torque of the displaced web."""
    body = arrays.bodies[place]
    radius = float(body["radius_m"])
    if parameters["shape"] == "orders":
        rows = [
            (n, float(parameters[f"cos{n}_m"]), float(parameters[f"sin{n}_m"])) for n in (1, 2, 3)
        ]
        shape = sum_orders(radius, rows)
    else:
        shape = shape_of(
            str(parameters["shape"]), float(parameters["size_m"]), radius,
            float(parameters["angle_rad"]),
        )  # fmt: skip
    web = arrays.web[0]
    wound = int(body["kind"]) in {UNWIND, REWIND}  # only there is the shape one of wound web
    if wound and float(parameters["gravity"]) != 0.0 and np.any(shape.deviation_m):
        mass = wound_mass(
            shape, core_radius_m=float(web["core_radius_m"]),
            density_kg_m3=float(web["density_kg_m3"]), width_m=float(web["width_m"]),
        )  # fmt: skip
        heavy = mass.mass_kg * GRAVITY_M_S2 * mass.offset_m * float(parameters["gravity"])
        add_heavy(arrays, place, heavy, mass.offset_angle_rad)
    return add_shape(arrays, place, shape)


def sum_orders(radius_m: float, rows: list[tuple[int, float, float]]) -> Shape:
    """Return h = R + sum cos_n cos(n psi) + sin_n sin(n psi) from (order, cos_m, sin_m)."""
    polar = []
    for order, cos_m, sin_m in rows:
        phasor = complex(cos_m, -sin_m)
        if phasor != 0:
            polar.append((order, abs(phasor), cmath.phase(phasor)))
    return orders(radius_m, polar)


EFFECT = Effect(
    name="out_of_round_roll",
    place="body",
    parameters={
        "shape": "flat", "size_m": 0.0, "angle_rad": 0.0, "gravity": 1.0,
        "cos1_m": 0.0, "sin1_m": 0.0, "cos2_m": 0.0, "sin2_m": 0.0, "cos3_m": 0.0, "sin3_m": 0.0,
    },
    apply=apply,
    text="the roll is not round: ripple at its turning frequency and several harmonics",
)  # fmt: skip
