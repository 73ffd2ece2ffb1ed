"""The report's figures as inline SVG."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from sim_plant.base.svg import svg
from sim_plant.refine.generic import LineSpectrum
from sim_plant.refine.holdout import Judgement

BEFORE, AFTER, MEASURED = "#b3261e", "#1a7f37", "#9aa0a6"
POINTS = 3000


def overlay(judged: Judgement, sample_time_s: float, seconds: float = 8.0) -> str:
    """Return measured against declared and amended, on the channels that gained most."""
    ratio = judged.before / np.maximum(judged.floor, 1e-12)
    gained = [k for k in np.argsort(-ratio) if not judged.channels[k].endswith(("rad", "_m"))]
    show = gained[:3] or [0]
    figure = Figure(figsize=(11, 2.4 * len(show)))
    axes = np.atleast_1d(figure.subplots(len(show), 1, sharex=True))
    part = slice(judged.first, judged.first + round(seconds / sample_time_s))
    time_s = np.arange(judged.measured.shape[1]) * sample_time_s
    for axis, k in zip(axes, show, strict=True):
        axis.plot(time_s[part], judged.measured[k, part], color=MEASURED, lw=0.8, label="measured")
        axis.plot(time_s[part], judged.declared[k, part], color=BEFORE, lw=0.9, label="declared")
        axis.plot(time_s[part], judged.amended[k, part], color=AFTER, lw=0.9, label="amended")
        axis.set_ylabel(judged.channels[k], fontsize=8)
        axis.grid(alpha=0.3)
    axes[0].legend(loc="upper right", fontsize=8, ncols=3)
    axes[-1].set_xlabel("time [s]")
    return svg(figure)


def spectrum(
    before: Sequence[LineSpectrum], after: Sequence[LineSpectrum], threshold: float
) -> str:
    """Return what a free line explains in time, travel and roll angle, with the threshold."""
    figure = Figure(figsize=(11, 2.6 * len(before)))
    axes = np.atleast_1d(figure.subplots(len(before), 1))
    labels = {"time": "Hz", "travel": "1/m", "angle": "order of "}
    for axis, first, last in zip(axes, before, after, strict=True):
        for drawn, colour, label in ((first, BEFORE, "before"), (last, AFTER, "after")):
            thin = max(1, drawn.drop.size // POINTS)
            size = drawn.drop.size // thin * thin
            peak = drawn.drop[:size].reshape(-1, thin).max(axis=1)
            axis.semilogy(drawn.coordinate[:size:thin], np.maximum(peak, 10.0), lw=0.7,
                          color=colour, label=label)  # fmt: skip
        axis.axhline(threshold, color="black", lw=0.7, ls=":")
        axis.set_xlabel(labels[first.kind] + first.roll)
        axis.set_ylabel("chi-square gain")
        axis.grid(alpha=0.3)
    axes[0].legend(fontsize=8)
    figure.tight_layout()
    return svg(figure)


def order_map(judged: Judgement, sample_time_s: float) -> str:
    """Return the residual's short-time spectrum before and after, on the channel hit hardest."""
    at = int(np.argmax(judged.before / np.maximum(judged.floor, 1e-12)))
    figure = Figure(figsize=(11, 3.2))
    axes = figure.subplots(1, 2, sharey=True)
    size = min(512, judged.measured.shape[1] // 4)
    window = np.hanning(size)
    for axis, model, title in (
        (axes[0], judged.declared, "before"), (axes[1], judged.amended, "after")
    ):  # fmt: skip
        residual = judged.measured[at] - model[at]
        starts = range(0, residual.size - size, size // 2)
        power = [np.abs(np.fft.rfft((residual[s : s + size] - residual[s : s + size].mean())
                                    * window)) for s in starts]  # fmt: skip
        level = 20.0 * np.log10(np.array(power).T + 1e-9)
        top = np.fft.rfftfreq(size, sample_time_s)
        keep = top <= 15.0
        scale = 20.0 * np.log10(judged.floor[at] * np.sqrt(size) + 1e-12)
        axis.imshow(
            level[keep], origin="lower", aspect="auto", vmin=scale - 6.0, vmax=scale + 30.0,
            extent=(0.0, residual.size * sample_time_s, 0.0, float(top[keep][-1])),
            cmap="magma", interpolation="nearest",
        )  # fmt: skip
        axis.set_title(f"{judged.channels[at]}, {title}", fontsize=9)
        axis.set_xlabel("time [s]")
    axes[0].set_ylabel("Hz")
    return svg(figure)
