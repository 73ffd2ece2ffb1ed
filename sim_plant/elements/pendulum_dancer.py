"""A dancer roller on an arm that swings about a pivot."""

from __future__ import annotations

import math

from sim_plant.base.jit import compiled


@compiled
def arm_acceleration(
    inertia_kg_m2: float,
    load_N_m: float,
    weight_N_m: float,
    damping_N_m_s: float,
    angle_rad: float,
    rate_rad_s: float,
    lever_in_m: float,
    lever_out_m: float,
    tension_in_N: float,
    tension_out_N: float,
) -> float:
    """Return the angular acceleration of the arm, rad/s2.

    Equation: J d2q/dt2 = M - m g l cos q - c dq/dt - b_in T_in - b_out T_out, q the arm's angle
    from the horizontal, counter-clockwise   [pendulum dancer named as future work in source
    chapter 6; form of Ebler et al., "Tension control: dancer rolls or load cells", IEEE Trans.
    Ind. Appl. 29, 1993]. ``inertia`` about the pivot with the roller as a point mass; ``lever``
    b = d(path length)/dq from ``span_lever``; ``weight`` = m g l. Never raises.
    """
    pull = lever_in_m * tension_in_N + lever_out_m * tension_out_N
    torque = load_N_m - weight_N_m * math.cos(angle_rad) - damping_N_m_s * rate_rad_s - pull
    return torque / inertia_kg_m2


@compiled
def span_lever(
    pivot_x_m: float,
    pivot_y_m: float,
    arm_m: float,
    angle_rad: float,
    fixed_x_m: float,
    fixed_y_m: float,
    reach_m: float,
    entering: bool,
) -> tuple[float, float]:
    """Return the lever of a span about the pivot and the span's length, both m.

    The lever is the perpendicular distance of the pivot from the span line, positive when a
    growing angle lengthens the path: +-arm sin(phi - angle), + for the span that enters the
    dancer roller. phi = atan2(dy, dx) - asin(reach / d) is the direction of the common tangent,
    ``reach`` = sigma_B R_B - sigma_A R_A (own derivation: d.C_B' of the span's identity, so that
    lever of the force and rate of length are one number). Never raises.
    """
    x = pivot_x_m + arm_m * math.cos(angle_rad)
    y = pivot_y_m + arm_m * math.sin(angle_rad)
    dx, dy = (x - fixed_x_m, y - fixed_y_m) if entering else (fixed_x_m - x, fixed_y_m - y)
    distance = math.hypot(dx, dy)
    phi = math.atan2(dy, dx) - math.asin(reach_m / distance)
    lever = arm_m * math.sin(phi - angle_rad)
    length = math.sqrt(distance * distance - reach_m * reach_m)
    return (lever if entering else -lever), length
