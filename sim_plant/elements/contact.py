"""Where a span touches its two bodies: exact common tangent, moment arms, contact flow."""

from __future__ import annotations

import math

from sim_plant.base.arrays import Array
from sim_plant.base.jit import compiled
from sim_plant.geometry.lookup import support_at


@compiled
def body_at(
    radius_m: float,
    sigma: float,
    row: int,
    h_m: Array,
    dh_m: Array,
    rho_m: Array,
    theta_rad: float,
    phi_rad: float,
) -> tuple[float, float, float]:
    """Return p, h' and the radius of curvature of one body for a span along ``phi_rad``, m."""
    if row < 0:
        return radius_m, 0.0, radius_m
    psi = sigma * phi_rad - 0.5 * math.pi - theta_rad
    h, dh, rho = support_at(h_m[row], dh_m[row], rho_m[row], psi)
    return radius_m + h, dh, radius_m + rho


@compiled
def tangent(
    dx_m: float,
    dy_m: float,
    sigma_a: float,
    p_a: float,
    dh_a: float,
    sigma_b: float,
    p_b: float,
    dh_b: float,
    phi_rad: float,
) -> tuple[float, float]:
    """Return the tangent residual F (m) and the span length L = dF/dphi (m) at ``phi_rad``.

    F = n.(C_B - C_A) + sigma_B p_B - sigma_A p_A with n = (sin phi, -cos phi). With the body
    angle psi = sigma phi - pi/2 - theta the derivative is d.(C_B - C_A) + h_B' - h_A', the
    distance from contact point to contact point (own derivation from the support function).
    """
    s, c = math.sin(phi_rad), math.cos(phi_rad)
    residual = s * dx_m - c * dy_m + sigma_b * p_b - sigma_a * p_a
    length = c * dx_m + s * dy_m + dh_b - dh_a
    return residual, length


@compiled
def turned_on(p_m: float, dh_m: float, rho_m: float, turn_rad: float) -> tuple[float, float]:
    """Return p and h' at a body angle ``turn_rad`` further, m: to first order, h'' = rho - p."""
    return p_m + turn_rad * dh_m, dh_m + turn_rad * (rho_m - p_m)
