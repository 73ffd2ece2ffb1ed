"""Unwind and rewind rolls: radius and inertia change with the web wound on them."""

from __future__ import annotations

import math

from sim_plant.base.jit import compiled


@compiled
def wound_inertia(
    density_kg_m3: float, width_m: float, radius_m: float, core_radius_m: float
) -> float:
    """Return the inertia of the wound web about its axis, kg m2.

    Equation: J_w = (pi/2) rho w (R^4 - R_c^4)   [source 2.4]. Never raises.
    """
    return 0.5 * math.pi * density_kg_m3 * width_m * (radius_m**4 - core_radius_m**4)


@compiled
def radius_rate(thickness_m: float, omega_rad_s: float, direction: float) -> float:
    """Return dR/dt, m/s; direction -1 unwinds, +1 rewinds.

    Equation: dR/dt = -+ t_w omega / (2 pi)   [source 2.5]. Never raises.
    """
    return direction * thickness_m * omega_rad_s / (2.0 * math.pi)
