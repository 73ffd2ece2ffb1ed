"""Rolls of the line that wind or unwind: radius, its rate, inertia."""

from __future__ import annotations

from sim_plant.base.arrays import REWIND, UNWIND, Array, LineArrays
from sim_plant.base.jit import compiled
from sim_plant.elements.material_roll import radius_rate, wound_inertia
from sim_plant.line.equations.layout import Layout


@compiled
def roll_inertia(p: LineArrays, fixed_kg_m2: float, radius_m: float) -> float:
    """Return core, drive and wound web together, kg m2   [source 2.3, 2.4]."""
    web = p.web[0]
    return fixed_kg_m2 + wound_inertia(web.density_kg_m3, web.width_m, radius_m, web.core_radius_m)


@compiled
def mean_radius(lay: Layout, y: Array, kind: int, fixed_m: float) -> float:
    """Return the mean radius of a body now, m."""
    if kind == UNWIND:
        return float(y[lay.radius])
    if kind == REWIND:
        return float(y[lay.radius + 1])
    return fixed_m


@compiled
def growth(kind: int, thickness_m: float, omega_rad_s: float) -> float:
    """Return dR/dt of a body, m/s: 0 unless it is a roll."""
    if kind == UNWIND:
        return radius_rate(thickness_m, omega_rad_s, -1.0)
    if kind == REWIND:
        return radius_rate(thickness_m, omega_rad_s, 1.0)
    return 0.0
