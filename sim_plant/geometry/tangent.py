"""The exact common tangent of two rotating bodies: span line, length, moment arms, flows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from aff_runtime.base.errors import PlantError
from sim_plant.geometry.shapes import Floats, Shape

_MAX_STEPS = 80
_STEP_TOLERANCE_RAD = 1e-14


@dataclass(frozen=True, slots=True, kw_only=True)
class Body:
    """A shape on an axis. ``rotation`` sigma is +1 counterclockwise, -1 clockwise."""

    center_x_m: float
    center_y_m: float
    rotation: int
    shape: Shape

    def __post_init__(self) -> None:
        if self.rotation not in {-1, 1}:
            raise PlantError(f"rotation must be +1 (ccw) or -1 (cw), got {self.rotation}")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Tangent:
    """The span from body A to body B; every field has the broadcast shape of the inputs.

    Attributes
    ----------
    phi_rad, phi_rate_rad_s : direction of web travel from +x and its rate.
    length_m, length_rate_m_s : contact point to contact point, and its rate.
    arm_a_m, arm_b_m : perpendicular distance rotation centre to span line; it is the arm of the
        tension's torque and, times omega, the web speed that the body imposes on the span.
    psi_a_rad, psi_b_rad : body angle of the contact normal.
    flow_a_m_s : rate of web length from A's surface into the span.
    flow_b_m_s : rate of web length from the span onto B's surface.
    """

    phi_rad: Floats
    phi_rate_rad_s: Floats
    length_m: Floats
    length_rate_m_s: Floats
    arm_a_m: Floats
    arm_b_m: Floats
    psi_a_rad: Floats
    psi_b_rad: Floats
    flow_a_m_s: Floats
    flow_b_m_s: Floats


def common_tangent(
    body_a: Body,
    body_b: Body,
    theta_a_rad: ArrayLike,
    theta_b_rad: ArrayLike,
    omega_a_rad_s: ArrayLike = 0.0,
    omega_b_rad_s: ArrayLike = 0.0,
) -> Tangent:
    """Return the span from ``body_a`` to ``body_b``, open or crossed, for arrays of angles.

    The contact normal of X stands at a = phi - sigma pi/2, in the body at psi = sigma a - theta,
    and the line touches both where F(phi) = (sin phi, -cos phi).(C_B - C_A) + sigma_B h_B -
    sigma_A h_A = 0. dF/dphi is the span length, so Newton inside a bracket finds it. Rates obey
    L phidot = sigma_B h_B' w_B - sigma_A h_A' w_A, ldot = (h + h'')(w - sigma phidot) and
    dL/dt + ldot_B - ldot_A = p_B w_B - p_A w_A.

    Replaces the source's (3.6)-(3.23), (4.1)-(4.34) and (4.44)-(4.50), with the wander of the
    contact point on both bodies.

    Raises
    ------
    PlantError
        When the bodies touch or overlap, so that no span exists.
    """
    theta_a, theta_b, omega_a, omega_b = np.broadcast_arrays(
        *(
            np.asarray(x, dtype=np.float64)
            for x in (theta_a_rad, theta_b_rad, omega_a_rad_s, omega_b_rad_s)
        )
    )
    phi = _solve(body_a, body_b, theta_a, theta_b)
    sigma_a, sigma_b = body_a.rotation, body_b.rotation
    psi_a, psi_b = _psi(body_a, phi, theta_a), _psi(body_b, phi, theta_b)
    h_a, slope_a, rho_a = body_a.shape.evaluate(psi_a)
    h_b, slope_b, rho_b = body_b.shape.evaluate(psi_b)
    along, across = _offsets(body_a, body_b, phi)
    length = along + slope_b - slope_a
    if np.any(length <= 0.0):
        raise PlantError("two bodies overlap: no span fits between them")
    phi_rate = (sigma_b * slope_b * omega_b - sigma_a * slope_a * omega_a) / length
    psi_rate_a = sigma_a * phi_rate - omega_a
    psi_rate_b = sigma_b * phi_rate - omega_b
    return Tangent(
        phi_rad=phi,
        phi_rate_rad_s=phi_rate,
        length_m=length,
        length_rate_m_s=(
            (rho_b - h_b) * psi_rate_b - (rho_a - h_a) * psi_rate_a - across * phi_rate
        ),
        arm_a_m=h_a,
        arm_b_m=h_b,
        psi_a_rad=psi_a,
        psi_b_rad=psi_b,
        flow_a_m_s=-rho_a * psi_rate_a,
        flow_b_m_s=-rho_b * psi_rate_b,
    )


def _psi(body: Body, phi: Floats, theta: Floats) -> Floats:
    """Return the body angle of the contact normal: sigma (phi - sigma pi/2) - theta."""
    return body.rotation * phi - 0.5 * np.pi - theta


def _offsets(body_a: Body, body_b: Body, phi: Floats) -> tuple[Floats, Floats]:
    """Return C_B - C_A along the span direction and across it, along (sin phi, -cos phi)."""
    dx = body_b.center_x_m - body_a.center_x_m
    dy = body_b.center_y_m - body_a.center_y_m
    cos_phi, sin_phi = np.cos(phi), np.sin(phi)
    return dx * cos_phi + dy * sin_phi, dx * sin_phi - dy * cos_phi


def _residual(
    body_a: Body, body_b: Body, theta_a: Floats, theta_b: Floats, phi: Floats
) -> tuple[Floats, Floats]:
    """Return F(phi) and dF/dphi."""
    h_a, slope_a, _ = body_a.shape.evaluate(_psi(body_a, phi, theta_a))
    h_b, slope_b, _ = body_b.shape.evaluate(_psi(body_b, phi, theta_b))
    along, across = _offsets(body_a, body_b, phi)
    residual: Floats = across + body_b.rotation * h_b - body_a.rotation * h_a
    return residual, along + slope_b - slope_a


def _solve(body_a: Body, body_b: Body, theta_a: Floats, theta_b: Floats) -> Floats:
    """Return phi by Newton, falling back to bisection within 90 degrees of the centre line.

    For disjoint bodies F is negative at one end, positive at the other, and of its two roots on
    the full turn only the one with L > 0 lies between.
    """
    dx = body_b.center_x_m - body_a.center_x_m
    dy = body_b.center_y_m - body_a.center_y_m
    chi = np.arctan2(dy, dx)
    lean = (
        body_a.rotation * body_a.shape.mean_radius_m - body_b.rotation * body_b.shape.mean_radius_m
    ) / np.hypot(dx, dy)
    low = np.full(theta_a.shape, chi - 0.5 * np.pi)
    high = np.full(theta_a.shape, chi + 0.5 * np.pi)
    f_low, _ = _residual(body_a, body_b, theta_a, theta_b, low)
    f_high, _ = _residual(body_a, body_b, theta_a, theta_b, high)
    if np.any(f_low >= 0.0) or np.any(f_high <= 0.0):
        raise PlantError("two bodies overlap: no span fits between them")
    phi = np.full(theta_a.shape, chi + np.arcsin(np.clip(lean, -1.0, 1.0)))
    for _ in range(_MAX_STEPS):
        f, slope = _residual(body_a, body_b, theta_a, theta_b, phi)
        low, high = np.where(f < 0.0, phi, low), np.where(f > 0.0, phi, high)
        newton = phi - f / np.where(slope > 0.0, slope, np.inf)
        outside = (slope <= 0.0) | (newton < low) | (newton > high)
        following = np.where(outside, 0.5 * (low + high), newton)
        change = float(np.max(np.abs(following - phi), initial=0.0))
        phi = following
        if change < _STEP_TOLERANCE_RAD:
            break
    return phi
