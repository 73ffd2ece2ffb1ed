"""One picture of the result, for the README: tension around arming, and ripple per order."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from sim_plant.base.svg import svg
from sim_plant.demo.evaluation import OrderReduction, window
from sim_plant.demo.plots import AFTER, BEFORE
from sim_plant.demo.session import Session

BEFORE_ARMED_S, AFTER_ARMED_S = 7.0, 33.0  # the probe ends some 9 s before
SHOWN_Hz = 40.0  # ripple up to some 10 Hz keeps its height
TENSION = "unwind_tension_N"
ROLL = "unwind"


def write_picture(session: Session, rows: Sequence[OrderReduction], path: Path) -> None:
    """Write the picture of a demo as an SVG file.

    Parameters
    ----------
    rows : all orders that were judged or shown; those of the unwind roll are drawn.
    """
    figure = Figure(figsize=(10, 2.9), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=[3, 2])
    _tension(left, session)
    _orders(right, [row for row in rows if row.roll == ROLL])
    path.write_text(svg(figure, tight=False, letters=True) + "\n", encoding="utf-8")


def _tension(axes: Axes, session: Session) -> None:
    """Draw the true tension from a little before arming until the ripple is gone."""
    armed = session.armed_at_s
    part = window(session.record, armed - BEFORE_ARMED_S, armed + AFTER_ARMED_S)
    time_s = part["time_s"] - armed
    step = max(1, round(1.0 / (SHOWN_Hz * float(np.median(np.diff(time_s))))))
    tension_N = part[f"true_{TENSION}"]
    for chosen, colour, label in (
        (time_s < 0.0, BEFORE, "PI alone"),
        (time_s >= 0.0, AFTER, "with AFF"),
    ):
        axes.plot(
            time_s[chosen][::step], tension_N[chosen][::step], color=colour, lw=0.7, label=label
        )
    axes.set_xlabel("time since arming [s]")
    axes.set_ylabel("unwind tension [N]")
    axes.grid(alpha=0.3)
    axes.legend(loc="upper right")


def _orders(axes: Axes, rows: Sequence[OrderReduction]) -> None:
    """Draw the amplitude of every order of the unwind roll, before and after."""
    orders = np.array([row.order for row in rows], dtype=float)
    axes.bar(orders - 0.2, [row.before_N for row in rows], 0.4, color=BEFORE, label="PI alone")
    axes.bar(orders + 0.2, [row.after_N for row in rows], 0.4, color=AFTER, label="with AFF")
    axes.set_xticks(orders)
    axes.set_xlabel("order of the unwind roll [1/turn]")
    axes.set_ylabel("tension ripple [N]")
    axes.grid(alpha=0.3, axis="y")
    axes.legend()
