"""Where a line rests: speeds and strains of its steady state, from its numbers alone.

Written apart from the kernel, so that the frequency model that stands on it checks the kernel.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array, IntArray
from sim_plant.line.arrays.build_bodies import carriages_of, heats_of
from sim_plant.line.declared.declaration import Declaration
from sim_plant.line.declared.laws import draws
from sim_plant.line.rest.resting_bodies import RestingBodies, carriage_forces, warmth_at

STICTION_SPEED_RAD_S = 0.3  # of the declaration's friction_law


@dataclass(frozen=True, slots=True, kw_only=True)
class SteadyLine:
    """A line at rest in its own frame.

    Attributes
    ----------
    radius_m, speed_m_s : of every body, (n,).
    strain : of every span, (n - 1,).
    travel_m : of every carriage, (g,).
    parts_K : warming of every part of a warm span, (h,).
    warm_strain, warm_step : strain that warmth alone makes, mean of every span, and how much
        more at its end, (n - 1,).
    """

    radius_m: Array
    speed_m_s: Array
    strain: Array
    travel_m: Array
    parts_K: Array
    warm_strain: Array
    warm_step: Array


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RestingLine:
    """The numbers that decide where a line rests; n bodies, n - 1 spans, d drives, l loops.

    Attributes
    ----------
    radius_m : moment arm of the web on every body, mean over a turn (n,).
    friction_constant_N_m, friction_viscous_N_m_s : of every body (n,).
    slip_s_m, slip_speed_m_s : share of speed the web loses above a speed (n,).
    EA_N, free_strain : of every span (n - 1,); what is free pulls nothing.
    supply_strain : of the web on the unwind.
    driven, ratio : bodies of the drives (d,) and their surface speed over the line's (d,).
    cell, acts_on, gain, offset_N : per tension loop, body of its cell, driven body, and what the
        cell makes of the tension (l,).
    bodies : what moves rollers or warms the web; None without.
    """

    radius_m: Array
    friction_constant_N_m: Array
    friction_viscous_N_m_s: Array
    slip_s_m: Array
    slip_speed_m_s: Array
    EA_N: Array
    free_strain: Array
    supply_strain: float
    driven: IntArray
    ratio: Array
    cell: IntArray
    acts_on: IntArray
    gain: Array
    offset_N: Array
    bodies: RestingBodies | None = None

    @property
    def carriages(self) -> int:
        """How many carriages move."""
        return 0 if self.bodies is None else self.bodies.carriages.size


def declared_line(line: Declaration) -> RestingLine:
    """Return the numbers of the declaration, without corrections and effects."""
    n, loops, drives = len(line.rollers), line.control.tension_pi, line.control.drives
    draw = line.control.pull_roll_draw
    return RestingLine(
        radius_m=radii_of(line),
        friction_constant_N_m=np.array([r.friction_constant_N_m for r in line.rollers]),
        friction_viscous_N_m_s=np.array([r.friction_viscous_N_m_s for r in line.rollers]),
        slip_s_m=np.zeros(n),
        slip_speed_m_s=np.zeros(n),
        EA_N=np.full(n - 1, line.web.EA_N),
        free_strain=np.zeros(n - 1),
        supply_strain=line.web.wound_in_tension_N / line.web.EA_N,
        driven=np.array([line.body(d.roller) for d in drives], dtype=np.int64),
        ratio=np.array([1.0 + (draw if draws(d.speed_reference) else 0.0) for d in drives]),
        cell=np.array([line.body(loop.load_cell) for loop in loops], dtype=np.int64),
        acts_on=np.array([line.body(loop.acts_on) for loop in loops], dtype=np.int64),
        gain=np.ones(len(loops)),
        offset_N=np.zeros(len(loops)),
        bodies=_declared_bodies(line),
    )


def _declared_bodies(line: Declaration) -> RestingBodies | None:
    """Return what of a declaration moves rollers or warms the web; None without."""
    if not line.carriages and not line.heated_spans:
        return None
    heats, first, parts = heats_of(line)
    loops = line.control.position_pi
    return RestingBodies(
        centre_m=np.array([(r.center_x_m, r.center_y_m) for r in line.rollers]),
        sigma=np.array([1.0 if r.rotation == "ccw" else -1.0 for r in line.rollers]),
        carriage=np.array([line.carriage_of(r.name) for r in line.rollers], dtype=np.int64),
        carriages=carriages_of(line),
        acts_on=np.array([line.body(loop.acts_on) for loop in loops], dtype=np.int64),
        held=np.array([line.carriage(loop.carriage) for loop in loops], dtype=np.int64),
        reference_m=np.array([loop.position_m for loop in loops]),
        heats=heats,
        first=first,
        parts=parts,
        expansion_1_K=line.web.thermal_expansion_1_K,
    )


def radii_of(line: Declaration) -> Array:
    """Return the radius of every body at the start, m, shape (n,)."""
    radius = np.array([roller.radius_m for roller in line.rollers])
    radius[0], radius[-1] = line.initial_radii_m.unwind, line.initial_radii_m.rewind
    return radius


def friction_of(line: Declaration, omega_rad_s: Array) -> tuple[Array, Array]:
    """Return friction torque (N m) and its slope over speed (N m s) of every body."""
    constant = np.array([roller.friction_constant_N_m for roller in line.rollers])
    viscous = np.array([roller.friction_viscous_N_m_s for roller in line.rollers])
    return friction_at(constant, viscous, omega_rad_s)


def friction_at(constant: Array, viscous: Array, omega_rad_s: Array) -> tuple[Array, Array]:
    """Return friction torque (N m) and its slope over speed (N m s): c tanh(w / 0.3) + b w."""
    level = np.tanh(omega_rad_s / STICTION_SPEED_RAD_S)
    slope = constant * (1.0 - level**2) / STICTION_SPEED_RAD_S + viscous
    return constant * level + viscous * omega_rad_s, slope


def inertias_of(line: Declaration, rest: SteadyLine) -> Array:
    """Return the inertia of every body, wound web included, kg m2 (source 2.3, 2.4)."""
    inertia = np.array([roller.inertia_kg_m2 for roller in line.rollers])
    ring = 0.5 * math.pi * line.web.density_kg_m3 * line.web.width_m
    core = line.initial_radii_m.core**4
    fixed = line.inertia_kg_m2
    inertia[0] = fixed.unwind_core_and_drive + ring * (rest.radius_m[0] ** 4 - core)
    inertia[-1] = fixed.rewind_core_and_drive + ring * (rest.radius_m[-1] ** 4 - core)
    return inertia


def steady_line(line: Declaration, line_speed_m_s: float, tension_N: float) -> SteadyLine:
    """Return the steady state of the declaration; see ``steady_state``."""
    return steady_state(declared_line(line), line_speed_m_s, tension_N)


def steady_state(line: RestingLine, line_speed_m_s: float, tension_N: float) -> SteadyLine:
    """Return the steady state at this line speed and tension reference.

    Equations: v_k / (1 + eps_k-1) is the same at every body (mass, source 2.20 at rest);
    R (T_down - T_up) = friction at every idler (source 2.32); a drive with a tension loop holds
    its load cell at the reference, one with a loop of travel its carriage, any other drive holds
    its speed; load, weight, spring and web balance at every carriage without a drive of its own,
    which rests where the file puts it. At standstill, where strain is free, tension is even. How
    warm the web is follows from the speeds, these from the strains: solved in turns.

    Raises
    ------
    PlantError
        When there is no single steady state.
    """
    n, spans = line.radius_m.size, line.EA_N.size
    strain = tension_N / line.EA_N + line.free_strain
    x = np.concatenate((np.full(n, line_speed_m_s), strain, np.zeros(line.carriages)))
    parts_K, warm = np.zeros(0), np.zeros((2, spans))
    for _ in range(3 if line.bodies is not None and line.bodies.heats.size else 1):
        if line.bodies is not None and line.bodies.heats.size:
            travel_m = x[n + spans :]
            parts_K, mean, end = warmth_at(line.bodies, line.radius_m, travel_m, x[:n])
            warm = line.bodies.expansion_1_K * np.stack((mean, end - mean))
        x = _balanced(line, line_speed_m_s, tension_N, x, warm)
    return SteadyLine(
        radius_m=line.radius_m,
        speed_m_s=x[:n],
        strain=x[n : n + spans],
        travel_m=x[n + spans :],
        parts_K=parts_K,
        warm_strain=warm[0],
        warm_step=warm[1],
    )


def _balanced(
    line: RestingLine, line_speed_m_s: float, tension_N: float, x: Array, warm: Array
) -> Array:
    """Return speeds, strains and travels at which nothing is missing, from a first guess."""
    n, spans = line.radius_m.size, line.EA_N.size
    sizes = (np.full(n, 1e-6), np.full(spans, 1e-8), np.full(line.carriages, 1e-6))
    scale = np.concatenate(sizes)
    for _ in range(30):
        residual = _imbalance(line, line_speed_m_s, tension_N, x, warm)
        if np.max(np.abs(residual)) < 1e-12:
            return x
        moved = _imbalance(line, line_speed_m_s, tension_N, x + np.diag(scale), warm)
        columns = (moved - residual).T
        try:
            x = x - np.linalg.solve(columns / scale, residual)
        except np.linalg.LinAlgError as error:
            raise PlantError(f"no single steady state at {line_speed_m_s} m/s") from error
    if np.max(np.abs(residual)) < 1e-9:
        return x
    raise PlantError(f"no steady state at {line_speed_m_s} m/s and {tension_N} N")


def _imbalance(
    line: RestingLine, line_speed_m_s: float, tension_N: float, x: Array, warm: Array
) -> Array:
    """Return what is missing from balance, (..., 2 n - 1 + g).

    Mass, then one equation per body, then one per carriage.
    """
    n, spans = line.radius_m.size, line.EA_N.size
    speed, strain, travel_m = x[..., :n], x[..., n : n + spans], x[..., n + spans :]
    over = np.maximum(np.abs(speed) - line.slip_speed_m_s, 0.0)
    web = speed * (1.0 - line.slip_s_m * over)
    supplied = np.full((*strain.shape[:-1], 1), line.supply_strain)
    leaving = strain + warm[1]
    upstream = np.concatenate((supplied, leaving[..., :-1]), axis=-1)
    mass = web[..., 1:] * (1.0 + upstream) - web[..., :-1] * (1.0 + leaving)
    pull_N = line.EA_N * (strain - line.free_strain - warm[0])
    friction, _slope = friction_at(
        line.friction_constant_N_m, line.friction_viscous_N_m_s, speed / line.radius_m
    )
    bodies = np.zeros_like(speed)
    inner = pull_N[..., 1:] - pull_N[..., :-1]
    bodies[..., 1:-1] = inner * line.radius_m[1:-1] - friction[..., 1:-1]
    bodies[..., line.driven] = speed[..., line.driven] - line_speed_m_s * line.ratio
    mean_N = 0.5 * (pull_N[..., line.cell - 1] + pull_N[..., line.cell])
    bodies[..., line.acts_on] = (line.gain * mean_N + line.offset_N - tension_N) / line.EA_N[0]
    if line.bodies is None or line.bodies.carriages.size == 0:
        return np.concatenate((mass, bodies), axis=-1)
    at = line.bodies
    bodies[..., at.acts_on] = travel_m[..., at.held] - at.reference_m
    forces = carriage_forces(at, line.radius_m, travel_m, pull_N) / line.EA_N[0]
    own = at.carriages["gain_rad_s"] > 0.0  # stands at travel 0 until its reference moves
    return np.concatenate((mass, bodies, np.where(own, travel_m, forces)), axis=-1)
