"""The source's closed forms for an eccentric roller behind a round one (3.2-3.22), corrected.

Frame of this file, as in the source's Fig. 3.2: origin at the upstream centre B, x towards the
rotation centre of the eccentric roller C; theta stands between the normal of that line and the
line rotation centre to geometric centre, which lies at (d0 + e sin theta, e cos theta). So theta
is a clockwise angle from +y, whatever the roller's sense. Independent check, not the model.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sim_plant.geometry.shapes import Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class EccentricPair:
    """Round upstream roller ``r1_m``, eccentric downstream roller ``r2_m``.

    ``d0_m`` is the distance of the rotation centres; ``over_wrap`` False is the crossed span.
    """

    d0_m: float
    eccentricity_m: float
    r1_m: float
    r2_m: float
    over_wrap: bool


def center_distance_m(pair: EccentricPair, theta_rad: ArrayLike) -> Floats:
    """Return d(t) between the geometric centres (3.9).

    Correction: for the over-wrap the source points to (3.3), which only the cross tangent obeys;
    (3.9) holds for both.
    """
    d0, e = pair.d0_m, pair.eccentricity_m
    distance: Floats = np.sqrt(d0**2 + 2.0 * e * d0 * np.sin(theta_rad) + e**2)
    return distance


def span_length_m(pair: EccentricPair, theta_rad: ArrayLike) -> Floats:
    """Return L: (3.8) and (3.10) under-wrap, (3.16) over-wrap; right as printed."""
    radii = pair.r1_m - pair.r2_m if pair.over_wrap else pair.r1_m + pair.r2_m
    length: Floats = np.sqrt(center_distance_m(pair, theta_rad) ** 2 - radii**2)
    return length


def span_length_rate_m_s(
    pair: EccentricPair, theta_rad: ArrayLike, omega_rad_s: ArrayLike
) -> Floats:
    """Return dL/dt (3.11); right as printed, and it holds for the over-wrap too."""
    swing = pair.d0_m * pair.eccentricity_m * np.asarray(omega_rad_s) * np.cos(theta_rad)
    rate: Floats = swing / span_length_m(pair, theta_rad)
    return rate


def contact_angle_rad(pair: EccentricPair, theta_rad: ArrayLike) -> Floats:
    """Return angle ACD at the geometric centre: (3.4)-(3.5), over-wrap (3.13)-(3.14).

    Correction: the text after (3.14) sets ACD = BAE; the right-angled triangles give ACD = ABE =
    90 deg - BAE. R2/AC is written (R1 +- R2)/d, which stays finite for equal radii.
    """
    radii = pair.r1_m - pair.r2_m if pair.over_wrap else pair.r1_m + pair.r2_m
    angle: Floats = np.arccos(radii / center_distance_m(pair, theta_rad))
    return angle


def entry_point_m(pair: EccentricPair, theta_rad: ArrayLike) -> tuple[Floats, Floats]:
    """Return the point P = D where the web meets the roller, x along the geometric centres.

    (3.6) under-wrap, (3.15) over-wrap with the angle of ``contact_angle_rad``.
    """
    angle = contact_angle_rad(pair, theta_rad)
    side = 1.0 if pair.over_wrap else -1.0
    x = center_distance_m(pair, theta_rad) + side * pair.r2_m * np.cos(angle)
    return x, side * pair.r2_m * np.sin(angle)


def rotation_center_m(pair: EccentricPair, theta_rad: ArrayLike) -> tuple[Floats, Floats]:
    """Return C_R in the frame of ``entry_point_m`` (3.19)-(3.21).

    Correction: the source gives cos(alpha) alone; sin(alpha) = -e cos(theta)/d carries the sign.
    Unsigned, the arm is wrong by up to 3.9 mm for e = 2 mm.
    """
    distance = center_distance_m(pair, theta_rad)
    cos_alpha = (pair.d0_m + pair.eccentricity_m * np.sin(theta_rad)) / distance
    sin_alpha = -pair.eccentricity_m * np.cos(theta_rad) / distance
    return pair.d0_m * cos_alpha, pair.d0_m * sin_alpha


def entry_arm_m(pair: EccentricPair, theta_rad: ArrayLike) -> Floats:
    """Return d_en cos(theta_en), the arm of the entering tension (3.17), (3.18), (3.22).

    Right as printed: it is the perpendicular distance p of the rotation centre from the span.
    """
    x, y = entry_point_m(pair, theta_rad)
    x_r, y_r = rotation_center_m(pair, theta_rad)
    d_en = np.hypot(x - x_r, y - y_r)
    r, e = pair.r2_m, pair.eccentricity_m
    cos_en = (r * r + d_en * d_en - e * e) / (2.0 * r * d_en)
    arm: Floats = d_en * cos_en
    return arm
