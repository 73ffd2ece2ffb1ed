"""The source's tangent of an elliptical roll and a round idler by minimisation (4.1-4.13).

Algorithms 1 and 2, corrected. Independent check, not the model.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar


@dataclass(frozen=True, slots=True, kw_only=True)
class EllipseLine:
    """An elliptical roll centred and turning at the origin, and a round idler.

    ``a_m``, ``b_m`` are semi-axes (correction: the source says lengths of the axes). ``upper``
    chooses the side of the centre line where the web leaves the roll; ``over_wrap`` False means
    that the span crosses the centre line.
    """

    a_m: float
    b_m: float
    idler_x_m: float
    idler_y_m: float
    idler_radius_m: float
    upper: bool
    over_wrap: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class SpanPoints:
    """Contact points on roll and idler in the fixed frame, x + j y, m."""

    roll: complex
    idler: complex

    @property
    def length_m(self) -> float:
        """Span length (4.34)."""
        return abs(self.idler - self.roll)


def ellipse_span(line: EllipseLine, delta_rad: float) -> SpanPoints:
    """Return the span for the roll turned by ``delta_rad`` counterclockwise (Algorithm 1).

    Corrections: the angle is theta(t), not omega t; the bounds are those of the body frame with
    the idler's centre turned by -theta, renewed for every theta (the printed [0, pi/2] and
    unrotated phi_0 hold only at theta = 0); the direction of the tangent is atan2(-alpha, beta),
    not atan2(beta, -alpha). The direction enters here through the unit normal itself.
    """
    turn = np.exp(1j * delta_rad)
    center = complex(line.idler_x_m, line.idler_y_m) / turn
    phi_0 = center_tangent_phi_rad(line, center)
    middle = float(np.angle(complex(center.real / line.a_m, center.imag / line.b_m)))
    toward = np.pi if line.upper else -np.pi
    limit = middle + toward if line.over_wrap else middle
    low, high = sorted((phi_0, phi_0 + _nearest(limit - phi_0, toward, over=line.over_wrap)))
    found = minimize_scalar(
        lambda phi: cost(line, phi, center),
        bounds=(low, high),
        method="bounded",
        options={"xatol": 1e-13, "maxiter": 500},
    )
    phi = _polish(line, float(found.x), center)
    alpha, beta, norm = _normal(line, phi)
    outward = complex(alpha, beta) / norm
    side = 1.0 if line.over_wrap else -1.0
    roll = complex(line.a_m * np.cos(phi), line.b_m * np.sin(phi))
    return SpanPoints(
        roll=roll * turn, idler=(center + side * line.idler_radius_m * outward) * turn
    )


def center_tangent_phi_rad(line: EllipseLine, center: complex) -> float:
    """Return phi_0, where the tangent passes through the idler's centre, body frame (4.9).

    Correction: + y_c / b in the numerator (printed -). Written with atan2 it holds in every
    quadrant: x_c/a cos(phi) + y_c/b sin(phi) = 1.
    """
    u, v = center.real / line.a_m, center.imag / line.b_m
    spread = np.arccos(1.0 / np.hypot(u, v))
    return float(np.arctan2(v, u) + (spread if line.upper else -spread))


def cost(line: EllipseLine, phi_rad: float, center: complex) -> float:
    """Return J = (d - R)^2 (4.7), Algorithm 2 with the idler's centre in the body frame.

    Corrections: Algorithm 2 returns the distance instead of J, and turns a point by (4.10) that
    already is in body coordinates; only the idler's centre is turned.
    """
    return (abs(signed_distance_m(line, phi_rad, center)) - line.idler_radius_m) ** 2


def signed_distance_m(line: EllipseLine, phi_rad: float, point: complex) -> float:
    """Return the distance of ``point`` outside the tangent at phi (4.2)-(4.6), (4.11), m.

    Correction of (4.3) and (4.5): |alpha x + beta y + gamma| / sqrt(alpha^2 + beta^2); the
    source takes the root of the whole fraction (0.2515 instead of 0.1400).
    """
    alpha, beta, norm = _normal(line, phi_rad)
    return (alpha * point.real + beta * point.imag - 1.0) / norm


def _normal(line: EllipseLine, phi: float) -> tuple[float, float, float]:
    """Return alpha, beta of (4.4) and their norm."""
    alpha, beta = float(np.cos(phi)) / line.a_m, float(np.sin(phi)) / line.b_m
    return alpha, beta, float(np.hypot(alpha, beta))


def _nearest(gap: float, toward: float, *, over: bool) -> float:
    """Return ``gap`` on the branch that leads away from (over) or back to the idler."""
    sense = np.sign(toward) if over else -np.sign(toward)
    return float(sense * np.mod(sense * gap, 2.0 * np.pi))


def _polish(line: EllipseLine, phi: float, center: complex) -> float:
    """Return the minimiser sharpened by Gauss-Newton steps on the residual of (4.7)."""
    wanted = -line.idler_radius_m if line.over_wrap else line.idler_radius_m
    step = 1e-6
    for _ in range(4):
        residual = signed_distance_m(line, phi, center) - wanted
        slope = (
            signed_distance_m(line, phi + step, center)
            - signed_distance_m(line, phi - step, center)
        ) / (2.0 * step)
        phi -= residual / slope
    return phi
