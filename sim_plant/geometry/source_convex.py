"""The source's tangent of a convex roll given by its radius r(phi) (4.21-4.34), corrected.

Frame: the roll turns round the origin, the idler's centre lies on +x, the web leaves the roll
on the upper side, and the roll is larger than the idler. Independent check, not the model.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from sim_plant.geometry.shapes import Floats
from sim_plant.geometry.source_ellipse import SpanPoints

Radius = Callable[[Floats], tuple[Floats, Floats]]
"""Polar angle -> (r, dr/dphi); ``extrema.radius_cubic`` is the source's choice (4.20)."""

_PENALTY_P = 1e3
_PENALTY_Q = 1e1
_SCAN = 2048


@dataclass(frozen=True, slots=True, kw_only=True)
class ConvexLine:
    """A roll of radius function ``radius`` and a round idler at (``distance_m``, 0)."""

    radius: Radius
    distance_m: float
    idler_radius_m: float
    over_wrap: bool


def convex_span(line: ConvexLine, theta_rad: float) -> tuple[SpanPoints, float]:
    """Return the span and the polar angle of the exit point for the roll turned by ``theta_rad``.

    argmin of J_p (4.28: the source writes min), points of (4.34). Shifting every extremum by
    theta, as the text after (4.34) does, is evaluating r at phi - theta.
    """
    grid = np.linspace(-0.5 * np.pi, 1.5 * np.pi, _SCAN)
    best = int(np.argmin(penalised_cost(line, grid, theta_rad)))
    found = minimize_scalar(
        lambda phi: float(penalised_cost(line, np.array([phi]), theta_rad)[0]),
        bounds=(grid[max(best - 1, 0)], grid[min(best + 1, _SCAN - 1)]),
        method="bounded",
        options={"xatol": 1e-13, "maxiter": 500},
    )
    phi = _polish(line, float(found.x), theta_rad)
    point, normal = _tangent(line, np.array([phi]), theta_rad)
    side = 1.0 if line.over_wrap else -1.0
    touch = line.distance_m + side * line.idler_radius_m * complex(normal[0])
    return SpanPoints(roll=complex(point[0]), idler=touch), phi


def penalised_cost(line: ConvexLine, phi_rad: Floats, theta_rad: float) -> Floats:
    """Return J_p (4.30)-(4.33) at polar angles ``phi_rad``.

    Corrections: (4.33) adds its conditions as numbers, so two at once weigh the cost by -1; they
    are a logical OR. The slope comparisons m_t, m_l fail at vertical tangents and are written
    with the normal: under-wrap needs the idler's centre outside the tangent, over-wrap inside,
    and a solution's normal points to the upper right.
    """
    distance = signed_distance_m(line, phi_rad, theta_rad)
    _, normal = _tangent(line, phi_rad, theta_rad)
    wrong_side = distance >= 0.0 if line.over_wrap else distance <= 0.0
    penalty = wrong_side | (normal.real < 0.0) | (normal.imag < 0.0)
    wrap = 1.0 if line.over_wrap else -1.0
    plain = (np.abs(distance) - line.idler_radius_m) ** 2
    cost: Floats = np.where(penalty, _PENALTY_P - wrap * _PENALTY_Q * phi_rad, plain)
    return cost


def signed_distance_m(line: ConvexLine, phi_rad: Floats, theta_rad: float) -> Floats:
    """Return the distance of the idler's centre outside the tangent at ``phi_rad`` (4.26), (4.27).

    Corrections: the root in (4.27) belongs to the denominator alone; (4.26) has no slope form
    for a vertical tangent, so the line is n . (x - P) = 0.
    """
    point, normal = _tangent(line, phi_rad, theta_rad)
    distance: Floats = ((line.distance_m - point) * np.conj(normal)).real
    return distance


def tangent_slope(radius_m: float, radius_slope_m: float, phi_rad: float) -> float:
    """Return m = dy/dx of the outline in polar form (4.23)-(4.25).

    Correction: (4.25) prints n/d with the sign of beta wrong in d_0, which is minus the
    reciprocal; m = -d/n with n = r sin - r' cos and d = r cos + r' sin.
    """
    sin_phi, cos_phi = np.sin(phi_rad), np.cos(phi_rad)
    n = radius_m * sin_phi - radius_slope_m * cos_phi
    d = radius_m * cos_phi + radius_slope_m * sin_phi
    return float(-d / n)


def _tangent(
    line: ConvexLine, phi: Floats, theta: float
) -> tuple[
    np.ndarray[tuple[int, ...], np.dtype[np.complex128]],
    np.ndarray[tuple[int, ...], np.dtype[np.complex128]],
]:
    """Return the outline's points and unit outward normals, x + j y."""
    r, slope = line.radius(np.asarray(phi) - theta)
    ray = np.exp(1j * np.asarray(phi))
    normal = (r - 1j * slope) * ray
    return r * ray, normal / np.abs(normal)


def _polish(line: ConvexLine, phi: float, theta: float) -> float:
    """Return the minimiser sharpened by Gauss-Newton steps on the residual of (4.28)."""
    wanted = -line.idler_radius_m if line.over_wrap else line.idler_radius_m
    step = 1e-6
    for _ in range(4):
        low, here, high = signed_distance_m(line, phi + step * np.array([-1.0, 0.0, 1.0]), theta)
        phi -= float((here - wanted) * 2.0 * step / (high - low))
    return phi
