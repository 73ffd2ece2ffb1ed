"""A dancer roller whose axis moves on a straight line."""

from __future__ import annotations

from sim_plant.base.jit import compiled


@compiled
def carriage_acceleration(
    mass_kg: float,
    load_N: float,
    stiffness_N_m: float,
    damping_N_s_m: float,
    position_m: float,
    speed_m_s: float,
    share_in: float,
    share_out: float,
    tension_in_N: float,
    tension_out_N: float,
) -> float:
    """Return the acceleration of the carriage, m/s2; positive lengthens the web path.

    Equation: m d2x/dt2 = F - k x - c dx/dt - a_in T_in - a_out T_out   [dancer named as future
    work in source chapter 6; form of Pagilla, Perera, Dwivedula, "The role of active dancers in
    tension control of webs", 2003]. ``share`` a = dL/dx of the span: the cosine between its
    direction and the motion, 1 for spans parallel to it. Never raises.
    """
    pull = share_in * tension_in_N + share_out * tension_out_N
    force = load_N - stiffness_N_m * position_m - damping_N_s_m * speed_m_s - pull
    return force / mass_kg


@compiled
def lengthening(share: float, speed_m_s: float) -> float:
    """Return what the motion adds to the length rate of one span, m/s.

    The span's identity with a moving centre C: dL/dt + ldot_B - ldot_A = p_B w_B - p_A w_A +
    d.(C_B' - C_A') (own derivation; source 2.21 has the same as xdot terms). The same ``share``
    carries force and length, so the web's power into the carriage is what the spans lose.
    """
    return share * speed_m_s
