"""How fast a line can move, and how fine its steps must be for that."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array, LineArrays, total_inertia_kg_m2
from sim_plant.elements.carriage import BUFFER_RAD_S, CREEP_M_S
from sim_plant.line.declared.declaration import Declaration
from sim_plant.line.rest.operating_point import declared_line
from sim_plant.line.rest.resting_bodies import spans_at

ACCURATE_STEP, STABLE_STEP = 1.0, 2.0
"""Of |lambda| h. The classical rule is stable to 2.6 anywhere in the left half plane; at 1 it is
wrong by 0.8 % of a radian per radian [h^5 / 120]. For differences stable steps are enough."""
MOST_SUBSTEPS = 32
TAU = 2.0 * math.pi


@dataclass(frozen=True, slots=True, kw_only=True)
class FastestMode:
    """The fastest that moves between two drive ticks: its rate, and which part of the line."""

    rate_rad_s: float
    where: str


def fastest_mode(line: Declaration, arrays: LineArrays, lengths_m: Array) -> FastestMode:
    """Return the fastest mode of a line, ``lengths_m`` (n - 1,) between its bodies.

    The largest eigenvalue of web and bodies without the transport of strain, which is slower:
    J dw/dt = R (T_down - T_up), L d eps/dt = v_down - v_up, T = EA (eps + eta d eps/dt)
    [source 2.32, 2.20]; carriages with it by their levers; beside it the corners of load cells,
    shafts, mandrel, carriages and warm spans.
    """
    return max(
        (
            _of_the_web(line, arrays, lengths_m),
            *_of_parts(line, arrays),
            *_of_bodies(line, arrays, lengths_m),
        ),
        key=lambda mode: mode.rate_rad_s,
    )


def substeps_for(mode: FastestMode, drive_tick_s: float, largest_step: float) -> int:
    """Return into how many steps a drive tick is to be divided.

    Raises
    ------
    PlantError
        When that is more than a declaration that is meant so would take.
    """
    wanted = max(1, math.ceil(mode.rate_rad_s * drive_tick_s / largest_step))
    if wanted > MOST_SUBSTEPS:
        raise PlantError(
            f"line: its fastest mode, {mode.where}, has {mode.rate_rad_s:.0f} rad/s and takes "
            f"{wanted} steps per drive tick of {drive_tick_s:g} s; expected at most "
            f"{MOST_SUBSTEPS}. Look at stiffness, length and inertia there, or give a shorter "
            "drive_sample_time_s"
        )
    return wanted


def _of_the_web(line: Declaration, p: LineArrays, lengths_m: Array) -> FastestMode:
    n, spans = p.bodies.size, p.spans.size
    carried = p.carriages.size
    rates = np.zeros((spans, n + spans + carried))  # d eps/dt of speeds, strains and carriages
    rows = np.arange(spans)
    rates[rows, rows], rates[rows, rows + 1] = -1.0 / lengths_m, 1.0 / lengths_m
    levers = _levers(line, p)
    rates[:, n + spans :] = levers / lengths_m[:, None]
    pulls = float(p.web["viscosity_s"][0]) * rates
    pulls[rows, n + rows] += 1.0 + float(p.web["maxwell_ratio"][0])
    pulls *= p.spans["EA_N"][:, None]
    turned = (p.bodies["radius_m"] ** 2 / _inertias(p))[:, None]
    none = np.zeros((1, pulls.shape[1]))
    moved = turned * (np.vstack((pulls, none)) - np.vstack((none, pulls)))
    pushed = -(levers / p.carriages["mass_kg"]).T @ pulls
    values, vectors = np.linalg.eig(np.vstack((moved, rates, pushed)))
    fastest = int(np.argmax(np.abs(values)))
    span = int(np.argmax(np.abs(vectors[n : n + spans, fastest])))
    ends = line.rollers[span].name, line.rollers[span + 1].name
    return FastestMode(
        rate_rad_s=float(abs(values[fastest])), where=f"the web between {ends[0]} and {ends[1]}"
    )


def _levers(line: Declaration, p: LineArrays) -> Array:
    """Return what a metre of each carriage's travel adds to each span at travel 0, (n - 1, g)."""
    found = np.zeros((p.spans.size, p.carriages.size))
    bodies = declared_line(line).bodies
    if bodies is None:
        return found
    at = spans_at(bodies, p.bodies["radius_m"], np.zeros(p.carriages.size))
    for c in range(p.carriages.size):
        found[:, c] = at.lever_b * (bodies.carriage[1:] == c)
        found[:, c] -= at.lever_a * (bodies.carriage[:-1] == c)
    return found


def _of_parts(line: Declaration, p: LineArrays) -> Iterator[FastestMode]:
    """Yield what moves beside the web: load cells, shafts, the mandrel, a web that relaxes."""
    for cell in p.cells:
        name = line.rollers[int(cell["body"])].name
        corner = TAU * max(float(cell["corner_Hz"]), float(cell["resonance_Hz"]))
        yield FastestMode(rate_rad_s=corner, where=f"the load cell of {name}")
    for drive in p.drives:
        body, stiffness = int(drive["body"]), float(drive["shaft_stiffness_N_m"])
        if stiffness > 0.0:
            fixed = float(p.bodies["inertia_kg_m2"][body])
            motor = float(drive["motor_share"]) * fixed
            light = 1.0 / motor + 1.0 / (fixed - motor)  # of a roll: once it is unwound
            damped = float(drive["shaft_damping_N_m_s"]) * light
            rate = max(math.sqrt(stiffness * light), damped)
            yield FastestMode(rate_rad_s=rate, where=f"the shaft of {line.rollers[body].name}")
    web = p.web[0]
    if web["bounce_mass_kg"] > 0.0:
        yield FastestMode(rate_rad_s=TAU * float(web["bounce_Hz"]), where="the unwind's mandrel")
    if web["maxwell_ratio"] != 0.0:
        rate = 1.0 / float(web["maxwell_time_s"])
        yield FastestMode(rate_rad_s=rate, where="the relaxation of the web")


def _of_bodies(line: Declaration, p: LineArrays, lengths_m: Array) -> Iterator[FastestMode]:
    """Yield what carriages have beside the web, and how fast heated spans change their web."""
    for given, carriage in zip(line.carriages, p.carriages, strict=True):
        slope = float(carriage["damping_N_s_m"] + carriage["friction_N"] / CREEP_M_S)
        mass = float(carriage["mass_kg"])
        spring = math.sqrt(float(carriage["stiffness_N_m"]) / mass)
        rate = max(slope / mass, spring, BUFFER_RAD_S, float(carriage["gain_rad_s"]))
        yield FastestMode(rate_rad_s=rate, where=f"the carriage of {given.name}")
    speed = abs(line.operating_point.line_speed_m_s)
    for i in np.flatnonzero(p.spans["heat_parts"]):
        parts, first = int(p.spans["heat_parts"][i]), int(p.spans["heat_first"][i])
        exchange_s = float(np.min(p.heats["time_s"][first : first + parts]))
        rate = parts * speed / float(lengths_m[i]) + 1.0 / exchange_s
        where = f"the warmth between {line.spans[i].start} and {line.spans[i].end}"
        yield FastestMode(rate_rad_s=rate, where=where)


def _inertias(p: LineArrays) -> Array:
    return np.array([total_inertia_kg_m2(p, k) for k in range(p.bodies.size)])
