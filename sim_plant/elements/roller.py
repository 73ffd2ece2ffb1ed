"""Torque balance of a body: friction, gravity on an off-axis centre of gravity."""

from __future__ import annotations

import math

from sim_plant.base.jit import compiled

STICTION_SPEED_RAD_S = 0.3
FULL_FRICTION = 20.0  # tanh is 1 to the last bit from 19.1 on, and slow
GRAVITY_M_S2 = 9.80665


@compiled
def friction_torque(constant_N_m: float, viscous_N_m_s: float, omega_rad_s: float) -> float:
    """Return the friction torque that opposes ``omega``, N m.

    Equation: tau_f = c tanh(omega / 0.3 rad/s) + b omega   [source 2.32, 2.44 with + signs; the
    tanh is the declaration's smooth sign]. Never raises.
    """
    ratio = omega_rad_s / STICTION_SPEED_RAD_S
    if ratio > FULL_FRICTION:
        level = 1.0
    elif ratio < -FULL_FRICTION:
        level = -1.0
    else:
        level = math.tanh(ratio)
    return constant_N_m * level + viscous_N_m_s * omega_rad_s


@compiled
def gravity_torque(
    gravity_moment_N_m: float, gravity_moment_angle_rad: float, sigma: float, theta_rad: float
) -> float:
    """Return the torque of an off-axis centre of gravity in the sense of transport, N m.

    Equation: -sigma m g e cos(gamma), gamma the global angle of the centre of gravity
    [source 3.17, 4.37; sign and angle corrected]. ``gravity_moment_N_m`` = m g e. Never raises.
    """
    if gravity_moment_N_m == 0.0:
        return 0.0
    return -sigma * gravity_moment_N_m * math.cos(sigma * (theta_rad + gravity_moment_angle_rad))
