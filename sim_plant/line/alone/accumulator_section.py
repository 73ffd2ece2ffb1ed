"""An accumulator between two driven speeds: a section on its own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.base.runge_kutta import fourth_order
from sim_plant.elements.accumulator import carriage_acceleration, strain_rate
from sim_plant.elements.span import tension

GRAVITY_M_S2 = 9.80665


@dataclass(frozen=True, slots=True, kw_only=True)
class Accumulator:
    """``spans`` parallel spans of web under a carriage of ``mass_kg`` at height x; L = N x."""

    EA_N: float
    strain_upstream: float
    spans: int
    mass_kg: float
    damping_N_s_m: float


def rates(a: Accumulator, state: Array, speeds: tuple[float, float], lift_N: float) -> Array:
    """Return d/dt of (strain, height m, carriage speed m/s)."""
    strain, height, speed = (float(v) for v in state)
    pull = tension(a.EA_N, strain, 0.0, 0.0)
    return np.array(
        [
            strain_rate(a.spans * height, a.spans, speed, strain, a.strain_upstream, *speeds),
            speed,
            carriage_acceleration(
                a.mass_kg, lift_N, a.damping_N_s_m, GRAVITY_M_S2, speed, a.spans, pull
            ),
        ]
    )


def simulate(
    a: Accumulator,
    start: Array,
    speeds: Callable[[float], tuple[float, float]],
    lift_N: float,
    duration_s: float,
    step_s: float,
) -> Array:
    """Return states (steps + 1, 3) by the classical fourth-order rule."""
    return fourth_order(
        lambda time, state: rates(a, state, speeds(time), lift_N), start, duration_s, step_s
    )


def rest_lift_N(a: Accumulator, strain: float) -> float:
    """Return the carriage force that holds this strain at rest: M g + N T."""
    return a.mass_kg * GRAVITY_M_S2 + a.spans * tension(a.EA_N, strain, 0.0, 0.0)
