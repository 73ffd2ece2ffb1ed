"""Moving rollers and warm web in a line at rest: geometry, forces and temperatures.

Written apart from the kernel, from the declared places of bodies that are circles.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sim_plant.base.arrays import Array, IntArray, Records
from sim_plant.elements.carriage import BUFFER_RAD_S

ComplexArray = npt.NDArray[np.complex128]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RestingBodies:
    """What decides where carriages rest and how warm the web is; n bodies, g carriages.

    Attributes
    ----------
    centre_m, sigma : of every body at travel 0 (n, 2), and its sense of rotation (n,).
    carriage : of every body, or -1 (n,).
    carriages : ``CARRIAGE`` (g,).
    acts_on, held, reference_m : of every loop of travel, driven body, carriage, travel (k,).
    heats, first, parts : ``HEAT`` (h,), and where those of each span are (n - 1,).
    expansion_1_K : of the web.
    """

    centre_m: Array
    sigma: Array
    carriage: IntArray
    carriages: Records
    acts_on: IntArray
    held: IntArray
    reference_m: Array
    heats: Records
    first: IntArray
    parts: IntArray
    expansion_1_K: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SpansAtRest:
    """Spans at some travel of the carriages, (..., n - 1) each: lengths, m, and levers."""

    length_m: Array
    lever_a: Array
    lever_b: Array


def spans_at(bodies: RestingBodies, radius_m: Array, travel_m: Array) -> SpansAtRest:
    """Return lengths and levers d.dC/ds of all spans at a travel (..., g) of the carriages."""
    centre, slope = _centres(bodies, travel_m)
    along = np.diff(centre, axis=-2)
    reach = np.diff(bodies.sigma * radius_m)
    distance = np.hypot(along[..., 0], along[..., 1])
    phi = np.arctan2(along[..., 1], along[..., 0]) - np.arcsin(reach / distance)
    direction = np.stack((np.cos(phi), np.sin(phi)), axis=-1)
    return SpansAtRest(
        length_m=np.sqrt(distance**2 - reach**2),
        lever_a=np.sum(direction * slope[..., :-1, :], axis=-1),
        lever_b=np.sum(direction * slope[..., 1:, :], axis=-1),
    )


def _centres(bodies: RestingBodies, travel_m: Array) -> tuple[Array, Array]:
    """Return centres and what they move per metre of travel, (..., n, 2) each."""
    shape = (*travel_m.shape[:-1], *bodies.centre_m.shape)
    centre, slope = np.broadcast_to(bodies.centre_m, shape).copy(), np.zeros(shape)
    for k in np.flatnonzero(bodies.carriage >= 0):
        c = int(bodies.carriage[k])
        start = complex(*bodies.centre_m[k])
        at, moved = moved_place(bodies.carriages[c], travel_m[..., c], start)
        centre[..., k, 0], centre[..., k, 1] = at.real, at.imag
        slope[..., k, 0], slope[..., k, 1] = moved.real, moved.imag
    return centre, slope


def moved_place(
    carriage: np.void, travel_m: Array, start: complex
) -> tuple[ComplexArray, ComplexArray]:
    """Return where x + iy of a carriage is at a travel, and its derivative over the travel."""
    place: ComplexArray
    if not carriage["pendulum"]:
        axis = np.complex128(complex(carriage["axis_x"], carriage["axis_y"]))
        place = np.asarray(start + travel_m * axis, dtype=np.complex128)
        return place, np.full(travel_m.shape, axis, dtype=np.complex128)
    pivot = complex(carriage["pivot_x_m"], carriage["pivot_y_m"])
    turn = complex(0.0, carriage["turn_1_m"])
    place = np.asarray((start - pivot) * np.exp(turn * travel_m), dtype=np.complex128)
    return pivot + place, turn * place


def carriage_forces(
    bodies: RestingBodies, radius_m: Array, travel_m: Array, pull_N: Array
) -> Array:
    """Return what the web, load, spring, weight and stops leave on every carriage, N (..., g)."""
    spans = spans_at(bodies, radius_m, travel_m)
    found = np.empty(travel_m.shape)
    for c, carriage in enumerate(bodies.carriages):
        travel = travel_m[..., c]
        place = complex(carriage["weight_x_m"], carriage["weight_y_m"])
        rise = moved_place(carriage, travel, place)[1].imag
        force = (
            carriage["load_N"] - carriage["stiffness_N_m"] * travel - carriage["weight_N"] * rise
        )
        past = travel - np.clip(travel, carriage["from_m"], carriage["to_m"])
        force = force - carriage["mass_kg"] * BUFFER_RAD_S**2 * past
        before, after = bodies.carriage[:-1] == c, bodies.carriage[1:] == c
        lever = spans.lever_b * after - spans.lever_a * before
        found[..., c] = force - np.sum(lever * pull_N, axis=-1)
    return found


def warmth_at(
    bodies: RestingBodies, radius_m: Array, travel_m: Array, speed_m_s: Array
) -> tuple[Array, Array, Array]:
    """Return warming at rest: of every part (h,), mean and end of every span (n - 1,), K.

    Along a part of length l the web goes to its surroundings by e^(-l / (v tau)).
    """
    length_m = spans_at(bodies, radius_m, travel_m).length_m
    parts_K = np.zeros(bodies.heats.size)
    mean, end = np.zeros((2, bodies.parts.size))
    entering = 0.0
    for i, count in enumerate(bodies.parts):
        for j in range(bodies.first[i], bodies.first[i] + count):
            air, time_s = float(bodies.heats["air_K"][j]), float(bodies.heats["time_s"][j])
            speed = abs(float(speed_m_s[i]))
            share = length_m[i] / (count * time_s * speed) if speed > 0.0 else np.inf
            leaving = air + (entering - air) * np.exp(-share)
            parts_K[j] = air + (entering - air) * -np.expm1(-share) / share
            entering = float(leaving)
        if count:
            at = slice(bodies.first[i], bodies.first[i] + count)
            mean[i], end[i] = float(np.mean(parts_K[at])), entering
    return parts_K, mean, end
