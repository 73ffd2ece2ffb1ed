"""Where a span touches its two bodies: exact common tangent, moment arms, contact flow."""

from __future__ import annotations

import math

from sim_plant.base.arrays import Array
from sim_plant.base.jit import compiled

TWO_PI = 2.0 * math.pi


@compiled
def shape_at(
    h_m: Array, dh_m: Array, rho_m: Array, psi_rad: float
) -> tuple[float, float, float]:
    """Return support deviation h, h' and h + h'' (deviation), m, at body angle ``psi_rad``.

    Tables hold ``points + 1`` values over one turn. h is a cubic Hermite of h and h'; h' is its
    exact derivative, so arm and length stay consistent; h + h'' is linear between nodes.
    Never raises.
    """
    points = h_m.size - 1
    step = TWO_PI / points
    turn = psi_rad - TWO_PI * math.floor(psi_rad / TWO_PI)
    cell = int(turn / step)
    cell = min(cell, points - 1)
    t = turn / step - cell
    h0, h1 = h_m[cell], h_m[cell + 1]
    g0, g1 = dh_m[cell] * step, dh_m[cell + 1] * step
    c2 = 3.0 * (h1 - h0) - 2.0 * g0 - g1
    c3 = g0 + g1 - 2.0 * (h1 - h0)
    h = h0 + t * (g0 + t * (c2 + t * c3))
    dh = (g0 + t * (2.0 * c2 + 3.0 * t * c3)) / step
    rho = rho_m[cell] + t * (rho_m[cell + 1] - rho_m[cell])
    return h, dh, rho


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
    h, dh, rho = shape_at(h_m[row], dh_m[row], rho_m[row], psi)
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
