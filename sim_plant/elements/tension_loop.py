"""The outer tension PI of unwind and rewind."""

from __future__ import annotations

from sim_plant.base.jit import compiled


@compiled
def tension_pi(
    gain_m_s_N: float,
    corner_rad_s: float,
    sign: float,
    error_N: float,
    integral_N_s: float,
    period_s: float,
) -> tuple[float, float]:
    """Return the velocity correction (m/s) and the new integral (N s) of one loop period.

    Equation: v = sign (k e + k w_c integral e)   [source 2.25, 2.26; gain read as FPM per lbf,
    sign -1 at the unwind because a faster unwind lowers tension]. Never raises.
    """
    grown = integral_N_s + period_s * error_N
    return sign * gain_m_s_N * (error_N + corner_rad_s * grown), grown
