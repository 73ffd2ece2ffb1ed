"""Arrays of what moves rollers and of what warms the web."""

from __future__ import annotations

import math

import numpy as np

from sim_plant.base.arrays import CARRIAGE, CHANGE, HEAT, TRAVEL_SPEED, IntArray, Records
from sim_plant.elements.roller import GRAVITY_M_S2
from sim_plant.line.declared.declaration import Declaration
from sim_plant.line.declared.declared_bodies import LinearDancer, PendulumDancer

LEAST_PARTS = 8
"""Of a heated span: each is one mean temperature; the front of a change is as sharp as these."""


def carriages_of(line: Declaration) -> Records:
    """Return the carriages of a line: dancers, then accumulators."""
    made = np.zeros(len(line.carriages), CARRIAGE)
    for row, given in zip(made, line.carriages, strict=True):
        first = line.rollers[line.body(given.rollers[0])]
        row["from_m"], row["to_m"] = given.travel_m
        row["weight_x_m"], row["weight_y_m"] = first.center_x_m, first.center_y_m
        row["drive_damping"] = 1.0
        if isinstance(given, PendulumDancer):
            _arm(row, given, math.hypot(*_from_pivot(line, given)))
            continue
        angle = math.radians(given.direction_deg)
        row["axis_x"], row["axis_y"] = math.cos(angle), math.sin(angle)
        row["mass_kg"] = given.mass_kg
        weight = given.mass_kg * GRAVITY_M_S2 if given.weight_N is None else given.weight_N
        row["weight_N"] = weight
        row["damping_N_s_m"], row["friction_N"] = given.damping_N_s_m, given.friction_N
        if isinstance(given, LinearDancer):
            row["load_N"], row["stiffness_N_m"] = given.load_N, given.stiffness_N_m
            continue
        row["load_N"] = given.lift_N
        if given.drive is not None:
            row["gain_rad_s"], row["drive_damping"] = given.drive.K_ref_rad_s, given.drive.zeta
            row["limit_N"] = given.drive.force_limit_N
    return made


def _from_pivot(line: Declaration, given: PendulumDancer) -> tuple[float, float]:
    first = line.rollers[line.body(given.rollers[0])]
    return first.center_x_m - given.pivot_x_m, first.center_y_m - given.pivot_y_m


def _arm(row: np.void, given: PendulumDancer, arm_m: float) -> None:
    """Fill in an arm's numbers along its first roller's circle: M = J / r2, F = torque / r."""
    row["pendulum"] = 1
    row["pivot_x_m"], row["pivot_y_m"] = given.pivot_x_m, given.pivot_y_m
    row["turn_1_m"] = (1.0 if given.rotation == "ccw" else -1.0) / arm_m
    row["mass_kg"] = given.inertia_kg_m2 / arm_m**2
    row["weight_N"], row["load_N"] = given.weight_N, given.load_N_m / arm_m
    row["stiffness_N_m"] = given.stiffness_N_m_rad / arm_m**2
    row["damping_N_s_m"], row["friction_N"] = (
        given.damping_N_m_s / arm_m**2,
        given.friction_N_m / arm_m,
    )


def moves_of(line: Declaration) -> Records:
    """Return the schedules of all accumulators as changes of their drives' references."""
    rows = []
    for given in line.accumulators:
        place = line.carriage(given.name)
        for move in given.schedule:
            times = (move.from_s, move.rise_s, move.until_s)
            rows.append((TRAVEL_SPEED, place, move.speed_m_s, *times, 0.0))
    return np.array(rows, CHANGE) if rows else np.zeros(0, CHANGE)


def heats_of(line: Declaration) -> tuple[Records, IntArray, IntArray]:
    """Return the parts of all spans that are warm, and of each span its first and how many.

    Behind the first heated span every other one has one part, as warm as the room makes it.
    """
    heated = {(given.start, given.end): given for given in line.heated_spans}
    rows: list[tuple[float, float]] = []
    first, parts = np.zeros((2, len(line.spans)), dtype=np.int64)
    for i, span in enumerate(line.spans):
        given = heated.get((span.start, span.end))
        first[i] = len(rows)
        if given is not None:
            each = math.ceil(LEAST_PARTS / len(given.warming_K))
            rows += [(air_K, given.exchange_s) for air_K in given.warming_K for _ in range(each)]
        elif rows:
            rows.append((0.0, line.web.room_exchange_s))
        parts[i] = len(rows) - first[i]
    return np.array(rows, HEAT) if rows else np.zeros(0, HEAT), first, parts
