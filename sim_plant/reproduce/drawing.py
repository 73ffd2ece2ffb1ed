"""Figures as inline SVG: panels of lines, bars, or points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

from sim_plant.base.svg import svg

COLOURS = ("#5f6368", "#b3261e", "#b06000", "#1a7f37", "#0b57d0", "#7b1fa2")
_MOST_POINTS = 1500

Curve = npt.NDArray[np.floating[Any]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Panel:
    """One set of axes: curves by label as (x, y).

    Attributes
    ----------
    marks : x positions of dotted lines, by label. log: axes on a log scale, "x", "y" or "xy".
    points : labels drawn as points.
    """

    curves: Mapping[str, tuple[Curve, Curve]]
    x: str
    y: str
    title: str = ""
    log: str = ""
    marks: Mapping[str, float] = field(default_factory=dict)
    points: tuple[str, ...] = ()
    equal: bool = False


def draw(panels: Sequence[Panel], columns: int = 2) -> str:
    """Return the panels side by side, ``columns`` to a row, as one SVG element."""
    columns = min(columns, len(panels))
    rows = -(-len(panels) // columns)
    figure = Figure(figsize=(5.6 * columns, 3.1 * rows), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False).ravel()
    for axis, panel in zip(axes, panels, strict=False):
        for number, (label, (x, y)) in enumerate(panel.curves.items()):
            style = "o" if label in panel.points else "-"
            keep = slice(None, None, max(1, len(x) // _MOST_POINTS))
            axis.plot(
                np.asarray(x)[keep],
                np.asarray(y)[keep],
                style,
                ms=4,
                lw=1.0,
                label=label,
                color=COLOURS[number % len(COLOURS)],
            )
        for label, position in panel.marks.items():
            axis.axvline(position, color="#9aa0a6", lw=0.8, ls=":")
            axis.annotate(
                label,
                (position, 1.0),
                xycoords=("data", "axes fraction"),
                fontsize=7,
                rotation=90,
                va="top",
                ha="right",
            )
        if "x" in panel.log:
            axis.set_xscale("log")
        if "y" in panel.log:
            axis.set_yscale("log")
        if panel.equal:
            axis.set_aspect("equal")
        axis.set_xlabel(panel.x)
        axis.set_ylabel(panel.y)
        axis.set_title(panel.title, fontsize=9)
        axis.grid(alpha=0.3)
        if len(panel.curves) > 1:
            axis.legend(fontsize=7)
    for axis in axes[len(panels) :]:
        axis.remove()
    return svg(figure, tight=False, letters=True)


def bars(
    groups: Mapping[str, Sequence[float]], names: Sequence[str], y: str, log: bool = False
) -> str:
    """Return grouped bars: ``groups`` by label, one bar for each of ``names``."""
    figure = Figure(figsize=(11.2, 3.1), layout="constrained")
    axis = figure.subplots()
    width = 0.8 / len(groups)
    for number, (label, values) in enumerate(groups.items()):
        at = np.arange(len(names)) + (number - 0.5 * (len(groups) - 1)) * width
        axis.bar(at, list(values), width, label=label, color=COLOURS[number % len(COLOURS)])
    axis.set_xticks(np.arange(len(names)), list(names), fontsize=8)
    axis.set_ylabel(y)
    if log:
        axis.set_yscale("log")
    axis.axhline(0.0, color="#202124", lw=0.6)
    axis.grid(alpha=0.3, axis="y")
    axis.legend(fontsize=7)
    return svg(figure, tight=False, letters=True)
