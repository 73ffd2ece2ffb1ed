"""The classical fourth-order rule, for sections that stand on their own."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sim_plant.base.arrays import Array


def fourth_order(
    rates: Callable[[float, Array], Array], start: Array, duration_s: float, step_s: float
) -> Array:
    """Return the states of d/dt state = ``rates``(time_s, state), one row a step, start first."""
    steps = round(duration_s / step_s)
    states = np.empty((steps + 1, start.size))
    states[0] = start
    half_s = 0.5 * step_s
    for k in range(steps):
        time_s = k * step_s
        s = states[k]
        one = rates(time_s, s)
        two = rates(time_s + half_s, s + half_s * one)
        three = rates(time_s + half_s, s + half_s * two)
        four = rates(time_s + step_s, s + step_s * three)
        states[k + 1] = s + step_s / 6.0 * (one + 2.0 * (two + three) + four)
    return states
