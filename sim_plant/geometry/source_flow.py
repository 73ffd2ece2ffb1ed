"""The source's material flow from arc length (4.44-4.46) and torque arm (4.37), corrected.

Independent check, not the model.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import quad

from sim_plant.geometry.shapes import Floats
from sim_plant.geometry.source_convex import Radius


def arc_length_m(radius: Radius, start_rad: float, end_rad: float) -> float:
    """Return the length of outline between two polar angles of the roll's own frame (4.44)."""

    def speed(phi: float) -> float:
        r, slope = radius(np.array([phi]))
        return float(np.hypot(r[0], slope[0]))

    value, _ = quad(speed, start_rad, end_rad, epsabs=1e-14, epsrel=1e-13, limit=200)
    return float(value)


def web_supply_m_s(
    flow_m_s: ArrayLike,
    length_rate_m_s: ArrayLike,
    phi_rate_rad_s: ArrayLike,
    downstream_radius_m: float,
    downstream_rotation: int,
    *,
    wander: bool,
) -> Floats:
    """Return what a roll adds to the span when (4.46) is used with v_i = R_i w_i, m/s.

    (4.46) as printed has dl/dt - dL/dt (``wander`` False). It takes the contact point on the
    downstream roller as fixed and errs by n R_B / L in harmonic n, 128 % for a crossed S-wrap
    pair. With the wander of that point, dl/dt - dL/dt + sigma_B R_B dphi/dt, the sum is p w
    exactly; sigma_B (+1 ccw, -1 cw) is the downstream roller's sense.
    """
    supply: Floats = np.asarray(flow_m_s, dtype=np.float64) - np.asarray(length_rate_m_s)
    if wander:
        supply = supply + downstream_rotation * downstream_radius_m * np.asarray(phi_rate_rad_s)
    return supply


def exit_distance_m(arm_m: ArrayLike, slope_m: ArrayLike) -> Floats:
    """Return d_ex, rotation centre to exit point, which (4.37) uses as torque arm.

    Correction: the arm of a force is the perpendicular distance p = h; d_ex = sqrt(h^2 + h'^2)
    exceeds it by up to 6.8 mm on a 12 mm flat spot.
    """
    distance: Floats = np.hypot(arm_m, slope_m)
    return distance
