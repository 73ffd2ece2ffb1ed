"""How fast a line can move, and how fine its steps must be for that."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array, LineArrays, total_inertia_kg_m2
from sim_plant.line.declaration import Declaration

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
    [source 2.32, 2.20]; beside it the corners of load cells, shafts and mandrel.
    """
    return max(
        (_of_the_web(line, arrays, lengths_m), *_of_parts(line, arrays)),
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
    rates = np.zeros((spans, n + spans))  # d eps/dt of speeds and strains
    rows = np.arange(spans)
    rates[rows, rows], rates[rows, rows + 1] = -1.0 / lengths_m, 1.0 / lengths_m
    pulls = float(p.web["viscosity_s"][0]) * rates
    pulls[rows, n + rows] += 1.0 + float(p.web["maxwell_ratio"][0])
    pulls *= p.spans["EA_N"][:, None]
    turned = (p.bodies["radius_m"] ** 2 / _inertias(p))[:, None]
    none = np.zeros((1, n + spans))
    moved = turned * (np.vstack((pulls, none)) - np.vstack((none, pulls)))
    values, vectors = np.linalg.eig(np.vstack((moved, rates)))
    fastest = int(np.argmax(np.abs(values)))
    span = int(np.argmax(np.abs(vectors[n:, fastest])))
    ends = line.rollers[span].name, line.rollers[span + 1].name
    return FastestMode(
        rate_rad_s=float(abs(values[fastest])), where=f"the web between {ends[0]} and {ends[1]}"
    )


def _of_parts(line: Declaration, p: LineArrays) -> Iterator[FastestMode]:
    """Yield what moves beside the web: load cells, shafts, the mandrel, a web that relaxes."""
    inertias = _inertias(p)
    for cell in p.cells:
        name = line.rollers[int(cell["body"])].name
        corner = TAU * max(float(cell["corner_Hz"]), float(cell["resonance_Hz"]))
        yield FastestMode(rate_rad_s=corner, where=f"the load cell of {name}")
    for drive in p.drives:
        body, stiffness = int(drive["body"]), float(drive["shaft_stiffness_N_m"])
        if stiffness > 0.0:
            motor = float(drive["motor_share"]) * float(p.bodies["inertia_kg_m2"][body])
            light = 1.0 / motor + 1.0 / (float(inertias[body]) - motor)
            damped = float(drive["shaft_damping_N_m_s"]) * light
            rate = max(math.sqrt(stiffness * light), damped)
            yield FastestMode(rate_rad_s=rate, where=f"the shaft of {line.rollers[body].name}")
    web = p.web[0]
    if web["bounce_mass_kg"] > 0.0:
        yield FastestMode(rate_rad_s=TAU * float(web["bounce_Hz"]), where="the unwind's mandrel")
    if web["maxwell_ratio"] != 0.0:
        rate = 1.0 / float(web["maxwell_time_s"])
        yield FastestMode(rate_rad_s=rate, where="the relaxation of the web")


def _inertias(p: LineArrays) -> Array:
    return np.array([total_inertia_kg_m2(p, k) for k in range(p.bodies.size)])
