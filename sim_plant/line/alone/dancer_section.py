"""Two spans with a dancer roller between two driven speeds: a section on its own."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.base.runge_kutta import fourth_order
from sim_plant.elements import linear_dancer, pendulum_dancer
from sim_plant.elements.span import strain_rate, tension

Speeds = Callable[[float], tuple[float, float]]
"""Time -> web speed into the section and out of it, m/s."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DancerWeb:
    """What both kinds share: web, lengths at rest and the dancer's roller."""

    EA_N: float
    strain_upstream: float
    length_in_m: float
    length_out_m: float
    roller_radius_m: float
    roller_inertia_kg_m2: float


@dataclass(frozen=True, slots=True, kw_only=True)
class LinearDancer:
    """A dancer between two spans parallel to its motion."""

    mass_kg: float
    load_N: float
    stiffness_N_m: float
    damping_N_s_m: float

    def geometry(self, web: DancerWeb, q: float) -> tuple[float, float, float, float]:
        """Return share and length of the entering and the leaving span."""
        return 1.0, web.length_in_m + q, 1.0, web.length_out_m + q

    def acceleration(
        self, q: float, rate: float, arms: tuple[float, float], pulls: tuple[float, float]
    ) -> float:
        """Return the second derivative of q, m/s2."""
        return linear_dancer.carriage_acceleration(
            self.mass_kg,
            self.load_N,
            self.stiffness_N_m,
            self.damping_N_s_m,
            q,
            rate,
            arms[0],
            arms[1],
            pulls[0],
            pulls[1],
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class PendulumDancer:
    """A dancer on an arm; the neighbours are fixed rollers of the same turning sense.

    Fixed rollers stand at (x, y) relative to the pivot, with ``reach`` = sigma_B R_B -
    sigma_A R_A of each span.
    """

    inertia_kg_m2: float
    load_N_m: float
    weight_N_m: float
    damping_N_m_s: float
    arm_m: float
    before_m: tuple[float, float]
    after_m: tuple[float, float]
    reach_in_m: float
    reach_out_m: float

    def geometry(self, web: DancerWeb, q: float) -> tuple[float, float, float, float]:
        """Return lever and length of the entering and the leaving span."""
        del web
        lever_in, length_in = pendulum_dancer.span_lever(
            0.0, 0.0, self.arm_m, q, self.before_m[0], self.before_m[1], self.reach_in_m, True
        )
        lever_out, length_out = pendulum_dancer.span_lever(
            0.0, 0.0, self.arm_m, q, self.after_m[0], self.after_m[1], self.reach_out_m, False
        )
        return lever_in, length_in, lever_out, length_out

    def acceleration(
        self, q: float, rate: float, arms: tuple[float, float], pulls: tuple[float, float]
    ) -> float:
        """Return the second derivative of q, rad/s2."""
        return pendulum_dancer.arm_acceleration(
            self.inertia_kg_m2,
            self.load_N_m,
            self.weight_N_m,
            self.damping_N_m_s,
            q,
            rate,
            arms[0],
            arms[1],
            pulls[0],
            pulls[1],
        )


Dancer = LinearDancer | PendulumDancer


def rates(web: DancerWeb, dancer: Dancer, state: Array, speeds: tuple[float, float]) -> Array:
    """Return d/dt of (strain in, strain out, roller speed m/s, q, dq/dt).

    The contact points' wander on the swinging roller is left out of the transport term alone; it
    is exact for the linear dancer and second order in strain for the pendulum.
    """
    eps_in, eps_out, roller_m_s, q, rate = (float(v) for v in state)
    arm_in, length_in, arm_out, length_out = dancer.geometry(web, q)
    speed_in, speed_out = speeds
    rate_in = strain_rate(
        length_in,
        eps_in,
        web.strain_upstream,
        speed_in,
        roller_m_s + linear_dancer.lengthening(arm_in, rate),
        speed_in,
    )
    rate_out = strain_rate(
        length_out,
        eps_out,
        eps_in,
        roller_m_s - linear_dancer.lengthening(arm_out, rate),
        speed_out,
        roller_m_s,
    )
    pulls = tension(web.EA_N, eps_in, 0.0, 0.0), tension(web.EA_N, eps_out, 0.0, 0.0)
    spin = web.roller_radius_m**2 * (pulls[1] - pulls[0]) / web.roller_inertia_kg_m2
    swing = dancer.acceleration(q, rate, (arm_in, arm_out), pulls)
    return np.array([rate_in, rate_out, spin, rate, swing])


def simulate(
    web: DancerWeb, dancer: Dancer, start: Array, speeds: Speeds, duration_s: float, step_s: float
) -> Array:
    """Return states (steps + 1, 5) by the classical fourth-order rule."""
    return fourth_order(
        lambda time, state: rates(web, dancer, state, speeds(time)), start, duration_s, step_s
    )


def rest_strain(web: DancerWeb, speed_in_m_s: float, speed_out_m_s: float) -> float:
    """Return the strain at rest: mass flows through, (1 + eps)/(1 + eps_up) = v_out/v_in."""
    return (1.0 + web.strain_upstream) * speed_out_m_s / speed_in_m_s - 1.0


def phasor(signal: Array, step_s: float, frequency_Hz: float, periods: int) -> complex:
    """Return the complex amplitude of a steady sine over the last whole ``periods``."""
    rows = round(periods / (frequency_Hz * step_s))
    part = signal[-rows:]
    time = step_s * np.arange(signal.size - rows, signal.size)
    wave = np.exp(-2j * math.pi * frequency_Hz * time)
    return complex(2.0 * np.mean((part - part.mean()) * wave))
