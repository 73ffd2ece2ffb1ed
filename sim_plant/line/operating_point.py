"""Where a declared line rests: speeds and strains of its steady state, from the declaration alone.

Written apart from the kernel, so that the frequency model that stands on it checks the kernel.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array
from sim_plant.line.declaration import Declaration

STICTION_SPEED_RAD_S = 0.3  # of the declaration's friction_law


@dataclass(frozen=True, slots=True, kw_only=True)
class SteadyLine:
    """A line at rest in its own frame.

    Attributes
    ----------
    radius_m, speed_m_s : of every body, (n,).
    strain : of every span, (n - 1,).
    """

    radius_m: Array
    speed_m_s: Array
    strain: Array


def radii_of(line: Declaration) -> Array:
    """Return the radius of every body at the start, m, shape (n,)."""
    radius = np.array([roller.radius_m for roller in line.rollers])
    radius[0], radius[-1] = line.initial_radii_m.unwind, line.initial_radii_m.rewind
    return radius


def friction_of(line: Declaration, omega_rad_s: Array) -> tuple[Array, Array]:
    """Return friction torque (N m) and its slope over speed (N m s) of every body."""
    constant = np.array([roller.friction_constant_N_m for roller in line.rollers])
    viscous = np.array([roller.friction_viscous_N_m_s for roller in line.rollers])
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
    """Return the steady state at this line speed and tension reference.

    Equations: v_k / (1 + eps_k-1) is the same at every body (mass, source 2.20 at rest);
    R (T_down - T_up) = friction at every idler (source 2.32); a drive with a tension loop holds
    its load cell at the reference, any other drive holds its speed. At standstill, where strain
    is free, tension is even.

    Raises
    ------
    PlantError
        When there is no single steady state.
    """
    n, radius = len(line.rollers), radii_of(line)
    wound_in = line.web.wound_in_tension_N / line.web.EA_N
    x = np.concatenate((np.full(n, line_speed_m_s), np.full(n - 1, tension_N / line.web.EA_N)))
    scale = np.concatenate((np.full(n, 1e-6), np.full(n - 1, 1e-8)))
    for _ in range(30):
        residual = _imbalance(line, radius, wound_in, line_speed_m_s, tension_N, x)
        if np.max(np.abs(residual)) < 1e-12:
            return SteadyLine(radius_m=radius, speed_m_s=x[:n], strain=x[n:])
        columns = [
            (_imbalance(line, radius, wound_in, line_speed_m_s, tension_N, x + step) - residual)
            for step in np.diag(scale)
        ]
        try:
            x = x - np.linalg.solve(np.array(columns).T / scale, residual)
        except np.linalg.LinAlgError as error:
            raise PlantError(f"no single steady state at {line_speed_m_s} m/s") from error
    if np.max(np.abs(residual)) < 1e-9:
        return SteadyLine(radius_m=radius, speed_m_s=x[:n], strain=x[n:])
    raise PlantError(f"no steady state at {line_speed_m_s} m/s and {tension_N} N")


def _imbalance(
    line: Declaration,
    radius_m: Array,
    wound_in_strain: float,
    line_speed_m_s: float,
    tension_N: float,
    x: Array,
) -> Array:
    """Return what is missing from balance, (2 n - 1,): mass, then one equation per body."""
    n = radius_m.size
    speed, strain = x[:n], x[n:]
    upstream = np.concatenate(([wound_in_strain], strain[:-1]))
    mass = speed[1:] * (1.0 + upstream) - speed[:-1] * (1.0 + strain)
    EA_N = line.web.EA_N
    friction, _slope = friction_of(line, speed / radius_m)
    bodies = np.zeros(n)
    bodies[1:-1] = EA_N * (strain[1:] - strain[:-1]) * radius_m[1:-1] - friction[1:-1]
    draw = line.control.pull_roll_draw
    for drive in line.control.drives:
        wanted = line_speed_m_s * (1.0 + (draw if "draw" in drive.speed_reference else 0.0))
        bodies[line.body(drive.roller)] = speed[line.body(drive.roller)] - wanted
    for loop in line.control.tension_pi:
        cell = line.body(loop.load_cell)
        mean_N = 0.5 * EA_N * (strain[cell - 1] + strain[cell])
        bodies[line.body(loop.acts_on)] = (mean_N - tension_N) / EA_N
    return np.concatenate((mass, bodies))
