"""A drive with its speed PI, sampled as drives are."""

from __future__ import annotations

from sim_plant.base.jit import compiled


@compiled
def speed_pi(
    inertia_kg_m2: float,
    gain_rad_s: float,
    damping: float,
    error_rad_s: float,
    integral_rad: float,
    tick_s: float,
    limit_N_m: float,
) -> tuple[float, float]:
    """Return the torque (N m) and the new integral (rad) of one drive tick.

    Equation: tau = J K (e + K/(4 zeta^2) integral e)   [source 2.24: K_p = J K_ref and
    w_ld = K_ref/(4 zeta^2), read with the parentheses]. The integral stops at the torque limit.
    Never raises.
    """
    corner = gain_rad_s / (4.0 * damping * damping)
    grown = integral_rad + tick_s * error_rad_s
    torque = inertia_kg_m2 * gain_rad_s * (error_rad_s + corner * grown)
    if torque > limit_N_m:
        return limit_N_m, integral_rad
    if torque < -limit_N_m:
        return -limit_N_m, integral_rad
    return torque, grown
