"""Spans in which the web is warmer or colder than on the unwind, in the line's equations."""

from __future__ import annotations

from sim_plant.base.arrays import Array, LineArrays
from sim_plant.base.jit import compiled_inside
from sim_plant.elements.web_climate import leaving_value
from sim_plant.line.equations.layout import Layout


@compiled_inside
def warm_span(
    p: LineArrays, lay: Layout, y: Array, i: int, renewal_1_s: float, entering_K: float, dy: Array
) -> tuple[float, float, float]:
    """Write the rates of warming of span ``i`` to ``dy``, one for each of its equal parts.

    Returns the mean warming of the span, K, its rate, K/s, and the warming of the web that
    leaves it. ``renewal`` = ldot_A / L. A heat balance for each part: what flows in, what flows
    out, what the surroundings give, dW/dt = n ldot_A / L (W_in - W_out) + (W_air - W) / tau.
    """
    span = p.spans[i]
    mean, rate, entering = 0.0, 0.0, entering_K
    parts = span.heat_parts
    if parts > 0:
        renewal = abs(renewal_1_s) * parts
        for part in range(parts):
            j = span.heat_first + part
            heat = p.heats[j]
            warming = y[lay.heat + j]
            leaving = leaving_value(warming, heat.air_K, renewal, heat.time_s)
            change = renewal * (entering - leaving) + (heat.air_K - warming) / heat.time_s
            dy[lay.heat + j] = change
            mean += warming / parts
            rate += change / parts
            entering = leaving
    return mean, rate, entering


@compiled_inside
def free_strains(
    p: LineArrays,
    lay: Layout,
    y: Array,
    i: int,
    flow_m_s: float,
    length_m: float,
    entering_K: float,
    dy: Array,
) -> tuple[float, float, float, float]:
    """Return the free strain of span ``i``: mean, at its end, rate (1/s); and warming there, K.

    ``flow`` = ldot_A. Where no span is warm all of it is as the span's own number says.
    """
    free = p.spans[i].free_strain
    if p.heats.size == 0:
        return free, free, 0.0, 0.0
    mean_K, rate_K_s, leaving_K = warm_span(p, lay, y, i, flow_m_s / length_m, entering_K, dy)
    expansion = p.web[0].expansion_1_K
    return (
        free + expansion * mean_K,
        free + expansion * leaving_K,
        expansion * rate_K_s,
        leaving_K,
    )
