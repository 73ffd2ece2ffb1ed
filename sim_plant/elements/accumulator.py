"""An accumulator: a carriage that stores web in many parallel spans."""

from __future__ import annotations

from sim_plant.base.jit import compiled


@compiled
def carriage_acceleration(
    mass_kg: float,
    lift_N: float,
    damping_N_s_m: float,
    gravity_m_s2: float,
    speed_m_s: float,
    spans: float,
    tension_N: float,
) -> float:
    """Return the acceleration of the carriage, m/s2, up positive.

    Equation: M dV/dt = F - M g - c V - N T   [accumulator named as future work in source
    chapter 6; Pagilla, Singh, Dwivedula, "A study on control of accumulators in web processing
    lines", J. Dyn. Syst. Meas. Control 126, 2004]. Never raises.
    """
    force = lift_N - mass_kg * gravity_m_s2 - damping_N_s_m * speed_m_s - spans * tension_N
    return force / mass_kg


@compiled
def strain_rate(
    stored_m: float,
    spans: float,
    carriage_speed_m_s: float,
    strain: float,
    strain_upstream: float,
    speed_in_m_s: float,
    speed_out_m_s: float,
) -> float:
    """Return d strain/dt of the stored web, 1/s, one mean strain for all spans.

    Equation: L deps/(1+eps) = N V + v_out - v_in - v_in (eps - eps_up)/(1+eps_up), L = N x + L_0
    [mean tension of all spans as in the paper above, exact in strain; source 2.20 with moving
    ends]. Conserves d(L/(1+eps))/dt = v_in/(1+eps_up) - v_out/(1+eps) exactly. Never raises.
    """
    transport = speed_in_m_s * (strain - strain_upstream) / (1.0 + strain_upstream)
    growth = spans * carriage_speed_m_s + speed_out_m_s - speed_in_m_s - transport
    return (1.0 + strain) / stored_m * growth
