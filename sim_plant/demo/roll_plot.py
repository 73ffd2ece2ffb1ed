"""The roll as the runtime has learned it: a polar plot in mm, from the runtime's own record."""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from aff_runtime.base.order_columns import order_columns
from sim_plant.base.arrays import Array
from sim_plant.base.svg import as_written, svg
from sim_plant.demo.plots import AFTER, BEFORE

POINTS = 720
FEWEST_ORDERS = 3
ROOM = 1.6  # radius of the round roll in the plot, in largest deviations


@dataclass(frozen=True, slots=True, kw_only=True)
class LearnedOrder:
    """One order of one roll: arm = R + deviation_mm cos(order angle + angle_deg)."""

    actuator: str
    roll: str
    order: int
    deviation_mm: float
    angle_deg: float


def learned_orders(columns: Mapping[str, Array]) -> list[LearnedOrder]:
    """Return what the runtime knew of the rolls at the end; empty with the plain law."""
    return [
        LearnedOrder(
            actuator=one.actuator,
            roll=one.roll,
            order=one.order,
            deviation_mm=float(columns[one.size][-1]),
            angle_deg=float(columns[one.phase_deg][-1]),
        )
        for one in order_columns(columns)
        if one.law == "shape" and one.roll and columns[one.size].size
    ]


def deviation_mm(orders: list[LearnedOrder], angle_rad: Array) -> Array:
    """Return the deviation of the moment arm over the roll's angle, mm."""
    total = np.zeros_like(angle_rad)
    for one in orders:
        w = cmath.rect(one.deviation_mm, math.radians(one.angle_deg))
        total += (w * np.exp(1j * one.order * angle_rad)).real
    return total


def roll_plot(orders: list[LearnedOrder]) -> str:
    """Return one polar plot per roll with several learned orders; empty without any."""
    rolls: dict[tuple[str, str], list[LearnedOrder]] = {}
    for one in orders:
        rolls.setdefault((one.actuator, one.roll), []).append(one)
    shown = {key: many for key, many in rolls.items() if len(many) >= FEWEST_ORDERS}
    if not shown:
        return ""
    angle = np.linspace(0.0, 2.0 * np.pi, POINTS + 1)
    figure = Figure(figsize=(5.5 * len(shown), 5.0))
    axes = figure.subplots(1, len(shown), subplot_kw={"projection": "polar"}, squeeze=False)[0]
    for axis, ((actuator, roll), many) in zip(axes, shown.items(), strict=True):
        deviation = deviation_mm(many, angle)
        size = max(float(np.max(np.abs(deviation))), 1e-3)
        axis.plot(
            angle, np.full_like(angle, ROOM * size), color=BEFORE, lw=1, ls="--", label="round"
        )
        axis.plot(angle, ROOM * size + deviation, color=AFTER, lw=1.6, label="learned")
        marks = np.linspace(-size, size, 5)
        axis.set_yticks(ROOM * size + marks, [f"{mark:+.1f} mm" for mark in marks], fontsize=8)
        axis.set_ylim(0.0, (ROOM + 1.15) * size)
        axis.set_title(
            f"{as_written(roll)}, as {as_written(actuator)} learned it: "
            "moment arm over the roll's angle",
            fontsize=10,
        )
        axis.legend(loc="lower left", bbox_to_anchor=(-0.1, -0.1), fontsize=8)
    return svg(figure)
