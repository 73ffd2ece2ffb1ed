"""A load-cell amplifier slower than declared."""

from __future__ import annotations

import math
from collections.abc import Mapping

from sim_plant.base.arrays import LineArrays
from sim_plant.base.effects import Effect, Parameter, Value

SHORTEST_TIME_S = 5e-4  # the integration step follows nothing faster


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Set the corner of cell ``place``, or add ``lag_s`` to its time constant.

    First order: d out/dt = (in - out) / tau, tau = 1 / (2 pi corner) + lag.
    """
    cell = arrays.cells[place]
    if float(parameters["corner_Hz"]) != 0.0:
        cell["corner_Hz"] = float(parameters["corner_Hz"])
    lag_s = float(parameters["lag_s"])
    if lag_s != 0.0:
        time_s = 1.0 / (2.0 * math.pi * float(cell["corner_Hz"])) + lag_s
        cell["corner_Hz"] = 1.0 / (2.0 * math.pi * max(time_s, SHORTEST_TIME_S))
    return arrays


def beside(there: Mapping[str, Value], more: Mapping[str, Value]) -> str:
    """Return that a corner takes the place of what is there; a lag comes on top."""
    is_there = any(float(there[name]) != 0.0 for name in ("corner_Hz", "lag_s"))
    if is_there and float(more["corner_Hz"]) != 0.0:
        return "and corner_Hz would take its place; give it first, or all lag as lag_s"
    return ""


def bounds(arrays: LineArrays, place: int) -> dict[str, tuple[float, float]]:
    """Return the lag at which no filter would be left: less than none is impossible."""
    tau_s = 1.0 / (2.0 * math.pi * float(arrays.cells["corner_Hz"][place]))
    return {"lag_s": (min(0.0, SHORTEST_TIME_S - tau_s), 2.0)}


EFFECT = Effect(
    name="load_cell_filter",
    place="cell",
    candidates="cell",
    accepts={
        "corner_Hz": Parameter(default=0.0, unit="Hz", typical=3.0, low=0.0, high=200.0),
        "lag_s": Parameter(default=0.0, unit="s", typical=0.02, low=-0.1, high=2.0, linear=True),
    },
    fitted=("lag_s",),
    apply=apply,
    bounds=bounds,
    beside=beside,
    text="a load-cell amplifier filters more than declared: readings and loop lag",
    shows=None,
    remedy="compare the filter set in the amplifier of {place} with low_pass_Hz as declared",
)
