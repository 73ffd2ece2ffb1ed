"""A heated or moistened span between two driven speeds: a section on its own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.base.runge_kutta import fourth_order
from sim_plant.elements.span import strain_rate, tension
from sim_plant.elements.web_climate import exchange_rate, free_strain


@dataclass(frozen=True, slots=True, kw_only=True)
class WarmSpan:
    """A span of ``length_m`` in an oven with time constant ``exchange_s``; web enters cold."""

    EA_N: float
    strain_upstream: float
    length_m: float
    expansion_1_K: float
    exchange_s: float


def rates(w: WarmSpan, state: Array, speeds: tuple[float, float], oven_K: float) -> Array:
    """Return d/dt of (strain, warming K)."""
    strain, warming = float(state[0]), float(state[1])
    speed_in, speed_out = speeds
    return np.array(
        [
            strain_rate(w.length_m, strain, w.strain_upstream, speed_in, speed_out, speed_in),
            exchange_rate(warming, 0.0, oven_K, speed_in / w.length_m, w.exchange_s),
        ]
    )


def pull_N(w: WarmSpan, strain: float, warming_K: float) -> float:
    """Return T = EA (eps - eps_f)."""
    free = free_strain(w.expansion_1_K, warming_K, 0.0, 0.0)
    return tension(w.EA_N, strain - free, 0.0, 0.0)


def simulate(
    w: WarmSpan,
    start: Array,
    speeds: Callable[[float], tuple[float, float]],
    oven_K: Callable[[float], float],
    duration_s: float,
    step_s: float,
) -> Array:
    """Return states (steps + 1, 2) by the classical fourth-order rule."""
    return fourth_order(
        lambda time, state: rates(w, state, speeds(time), oven_K(time)), start, duration_s, step_s
    )
