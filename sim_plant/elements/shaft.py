"""A drive shaft that twists and has play."""

from __future__ import annotations

from sim_plant.base.jit import compiled


@compiled
def shaft_torque(
    stiffness_N_m: float, damping_N_m_s: float, backlash_rad: float, twist: float, rate: float
) -> float:
    """Return the torque through a compliant shaft with backlash, N m.

    Equation: tau = K (twist -+ b/2) + D d twist/dt outside the play b, 0 inside. Never raises.
    """
    half = 0.5 * backlash_rad
    if twist > half:
        return stiffness_N_m * (twist - half) + damping_N_m_s * rate
    if twist < -half:
        return stiffness_N_m * (twist + half) + damping_N_m_s * rate
    return 0.0
