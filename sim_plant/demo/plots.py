"""The report's plots as inline SVG."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from aff_runtime.base.order_columns import order_columns
from sim_plant.base.arrays import Array
from sim_plant.base.order_tracking import order_spectrum
from sim_plant.base.svg import as_written, svg
from sim_plant.demo.evaluation import window
from sim_plant.demo.session import Session

BEFORE, AFTER = "#9aa0a6", "#1a7f37"
SIZE_AXES = {
    "mm": (1.0, "shape [mm]"),
    "m/s": (1e3, "amplitude [mm/s]"),
    "N m": (1.0, "amplitude [N m]"),
}
"""By the unit of an order's size: factor and name of the axis."""


def tension_plot(session: Session) -> str:
    """Tension over the whole session, both zones, thinned to what a screen can show."""
    record = session.record
    step = max(1, record["time_s"].size // 6000)
    figure = Figure(figsize=(11, 5))
    axes = figure.subplots(2, 1, sharex=True)
    names = ("unwind_tension_N", "pullroll_tension_N")
    for axis, name in zip(axes, names, strict=True):
        axis.plot(
            record["time_s"][::step], record[f"true_{name}"][::step], lw=0.6, color="#0b57d0"
        )
        axis.axvline(session.armed_at_s, color=AFTER, lw=1)
        axis.axvspan(*session.before_s, color=BEFORE, alpha=0.2)
        axis.axvspan(*session.after_s, color=AFTER, alpha=0.15)
        axis.set_ylabel(f"{name.removesuffix('_N').replace('_', ' ')} [N]")
        axis.grid(alpha=0.3)
    axes[-1].set_xlabel("plant time [s]; grey: PI alone, green: with AFF, line: armed")
    return svg(figure)


def spectrum_plot(session: Session) -> str:
    """Order spectra before and after, each on its roll's own angle."""
    figure = Figure(figsize=(11, 3.6))
    axes = figure.subplots(1, 2)
    pairs = (("unwind_tension_N", "unwind"), ("pullroll_tension_N", "swrap_follower"))
    for axis, (name, roll) in zip(axes, pairs, strict=True):
        for span, colour, label in (
            (session.before_s, BEFORE, "PI alone"),
            (session.after_s, AFTER, "with AFF"),
        ):
            part = window(session.record, *span)
            orders, amplitude = order_spectrum(
                part[f"true_{name}"], part[f"true_{roll}_angle_rad"], 8.0
            )
            axis.semilogy(orders, np.maximum(amplitude, 1e-4), color=colour, lw=1, label=label)
        axis.set_xlabel(f"order of {roll} [1/turn]")
        axis.set_ylabel(f"{name.removesuffix('_N').replace('_', ' ')} amplitude [N]")
        axis.grid(alpha=0.3, which="both")
        axis.legend()
    return svg(figure)


def block_plot(columns: Mapping[str, Array]) -> str:
    """Amplitude and phase of every block over the run, from the runtime's own record."""
    time = columns["time_s"]
    step = max(1, time.size // 800)
    orders = order_columns(columns)
    kinds = sorted({order.size_unit for order in orders} & set(SIZE_AXES)) or ["m/s"]
    figure = Figure(figsize=(11, 2.5 * (len(kinds) + 1)))
    axes = figure.subplots(len(kinds) + 1, 1, sharex=True)
    for axis, unit in zip(axes, kinds, strict=False):
        factor, words = SIZE_AXES[unit]
        for order in (one for one in orders if one.size_unit == unit):
            label = as_written(order.key)
            axis.plot(time[::step], factor * columns[order.size][::step], lw=1, label=label)
            if order.phase_deg:
                axes[-1].plot(
                    time[::step], columns[order.phase_deg][::step], ".", ms=1, label=label
                )
        axis.set_ylabel(words)
        if axis.lines:
            axis.legend(fontsize=7, ncols=5, loc="lower center", bbox_to_anchor=(0.5, 1.0))
    axes[-1].set_ylabel("phase [deg]")
    axes[-1].set_xlabel("runtime time [s]")
    for axis in axes:
        axis.grid(alpha=0.3)
    return svg(figure)


def timing_plot(columns: Mapping[str, Array]) -> str:
    """How late ticks woke, how long the wire took, and the whole tick."""
    figure = Figure(figsize=(11, 3))
    axis = figure.subplots()
    bins = np.logspace(0.5, 4.5, 80)
    for name, colour in (("wake_us", "#0b57d0"), ("io_us", "#b06000"), ("tick_us", AFTER)):
        values = columns[name][np.isfinite(columns[name])]
        p50, p99 = np.percentile(values, [50, 99])
        label = f"{name.removesuffix('_us')}: p50 {p50:.0f} us, p99 {p99:.0f} us"
        axis.hist(
            np.maximum(values, 4.0), bins=list(bins), histtype="step", color=colour, label=label
        )
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xlabel("us")
    axis.set_ylabel("ticks")
    axis.grid(alpha=0.3)
    axis.legend()
    return svg(figure)
