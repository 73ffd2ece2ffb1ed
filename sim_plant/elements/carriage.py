"""What a dancer's or an accumulator's rollers are mounted on: forces along its travel."""

from __future__ import annotations

import math

from sim_plant.base.jit import compiled

CREEP_M_S = 0.005
BUFFER_RAD_S = 100.0


@compiled
def friction_force(constant_N: float, viscous_N_s_m: float, speed_m_s: float) -> float:
    """Return the force that opposes the travel, N: F = c tanh(v / 5 mm/s) + b v.

    [Friction and damping of a carriage as in Pagilla, Singh, Dwivedula 2004, with a smooth sign
    as the bearings have it.] Never raises.
    """
    return constant_N * math.tanh(speed_m_s / CREEP_M_S) + viscous_N_s_m * speed_m_s


@compiled
def buffer_force(
    mass_kg: float, from_m: float, to_m: float, travel_m: float, speed_m_s: float
) -> float:
    """Return the force of a stop at each end of the travel, N: towards the middle, never back.

    A spring of M (100 rad/s)^2 that is damped critically, so that no stop is faster than that
    [own]. Never raises.
    """
    stiffness = mass_kg * BUFFER_RAD_S * BUFFER_RAD_S
    damping = 2.0 * mass_kg * BUFFER_RAD_S
    if travel_m > to_m:
        return min(0.0, -stiffness * (travel_m - to_m) - damping * speed_m_s)
    if travel_m < from_m:
        return max(0.0, -stiffness * (travel_m - from_m) - damping * speed_m_s)
    return 0.0
