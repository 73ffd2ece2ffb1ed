"""A free span: strain from mass balance, tension from strain."""

from __future__ import annotations

from sim_plant.base.jit import compiled


@compiled
def strain_rate(
    length_m: float,
    strain: float,
    strain_upstream: float,
    length_rate_in_m_s: float,
    length_rate_out_m_s: float,
    contact_flow_in_m_s: float,
) -> float:
    """Return d strain/dt, 1/s.

    Equation: L deps/(1+eps) = p_B w_B - p_A w_A - ldot_A (eps - eps_up)/(1+eps_up)
    [source 2.20, 3.1, 4.46 in one exact identity: span-length rate and material flow collapse to
    the moment arms p]. ``length_rate_*`` = p w of the entry and exit body, ``contact_flow_in``
    = ldot_A, the stretched length that leaves body A per second. Where a profile is not convex
    it changes its sign: the length along the curve, |h + h''| dpsi, counts. Never raises.
    """
    transport = abs(contact_flow_in_m_s) * (strain - strain_upstream) / (1.0 + strain_upstream)
    return (1.0 + strain) / length_m * (length_rate_out_m_s - length_rate_in_m_s - transport)


@compiled
def tension(EA_N: float, strain: float, viscosity_s: float, rate_1_s: float) -> float:
    """Return tension, N, never below zero: a slack web pulls nothing.

    Equation: T = EA (eps + eta deps/dt)   [Hooke, source before 2.21; Kelvin-Voigt damping].
    """
    return max(0.0, EA_N * (strain + viscosity_s * rate_1_s))


@compiled
def maxwell_rate(
    branch: float,
    branch_upstream: float,
    strain_step: float,
    rate_1_s: float,
    time_s: float,
    renewal_1_s: float,
) -> float:
    """Return d branch/dt of the elastic strain in a Maxwell branch, averaged over a span, 1/s.

    Equation: db/dt = deps/dt - b/tau + (ldot_A/L) (b_up + eps - eps_up - b)   [own derivation: a
    particle keeps its branch strain over a roller and is stretched there by the step of strain;
    ``renewal`` = ldot_A/L replaces the web in the span]. Never raises.
    """
    fresh = branch_upstream + strain_step
    return rate_1_s - branch / time_s + renewal_1_s * (fresh - branch)


@compiled
def two_webs(EA_N: float, ratio: float, share: float) -> float:
    """Return the EA of a span with this share of web of ``ratio`` times EA: springs in series."""
    return EA_N / (1.0 - share + share / ratio)
