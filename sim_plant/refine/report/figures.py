"""The report's figures as inline SVG."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from sim_plant.base.svg import as_written, svg
from sim_plant.refine.judge.holdout import Evaluation
from sim_plant.refine.spectra.spectral_lines import SpectralLines

BEFORE, AFTER, MEASURED = "#b3261e", "#1a7f37", "#9aa0a6"
POINTS = 3000
"""At least so many points are drawn of a longer spectrum, each the largest of its neighbours."""
HIGHEST_HZ = 15.0
"""Highest frequency of the map over web travel, at the highest speed of the record."""


def overlay(judged: Evaluation, sample_time_s: float, seconds: float = 8.0) -> str:
    """Return measured against declared and amended, and the error of both.

    The three channels with the largest error before, one of them a tension where there is one;
    of the record the ``seconds`` in which the declared line is worst.
    """
    ranked = channels_by_error(judged)
    show = ranked[:3]
    tensions = [k for k in ranked if judged.channels[k].endswith("_N")]
    if tensions and not set(tensions) & set(show):
        show = [*show[:2], tensions[0]]
    figure = Figure(figsize=(12, 2.3 * len(show)))
    axes = figure.subplots(len(show), 2, sharex=True, squeeze=False)
    part = worst_part(judged, show[0], max(1, round(seconds / sample_time_s)))
    time_s = np.arange(judged.measured.shape[1]) * sample_time_s
    for row, k in zip(axes, show, strict=True):
        measured = judged.measured[k, part]
        row[0].plot(time_s[part], measured, color=MEASURED, lw=2.0, label="measured")
        for model, colour, label in (
            (judged.declared, BEFORE, "declared"),
            (judged.amended, AFTER, "amended"),
        ):
            row[0].plot(time_s[part], model[k, part], color=colour, lw=0.9, label=label)
            row[1].plot(
                time_s[part],
                measured - model[k, part],
                color=colour,
                lw=0.8,
                label=f"error as {label}",
            )
        row[0].set_ylabel(as_written(judged.channels[k]), fontsize=8)
        for axis in row:
            axis.grid(alpha=0.3)
    for axis in axes[0]:
        axis.legend(
            loc="lower center", bbox_to_anchor=(0.5, 1.0), fontsize=8, ncols=3, frameon=False
        )
    for axis in axes[-1]:
        axis.set_xlabel("time [s]")
    figure.tight_layout()
    return svg(figure)


def worst_part(judged: Evaluation, channel: int, samples: int) -> slice:
    """Return where the declared line is furthest off the measured, ``samples`` judged samples."""
    squared = (judged.measured[channel] - judged.declared[channel])[judged.first :] ** 2
    samples = min(samples, squared.size)
    total = np.concatenate(([0.0], np.cumsum(squared)))
    start = judged.first + int(np.argmax(total[samples:] - total[:-samples]))
    return slice(start, start + samples)


def spectrum(
    before: Sequence[SpectralLines], after: Sequence[SpectralLines], threshold: float
) -> str:
    """Return what a free spectral line explains in time, travel and roll angle, chi-square."""
    figure = Figure(figsize=(11, 2.6 * len(before)))
    axes = np.atleast_1d(figure.subplots(len(before), 1))
    labels = {"time": "Hz", "travel": "1/m of web", "angle": "times per turn of "}
    for axis, first, last in zip(axes, before, after, strict=True):
        for drawn, colour, label in ((first, BEFORE, "before"), (last, AFTER, "after")):
            thin = max(1, drawn.chi2_reduction.size // POINTS)
            size = drawn.chi2_reduction.size // thin * thin
            peak = drawn.chi2_reduction[:size].reshape(-1, thin).max(axis=1)
            axis.semilogy(
                drawn.coordinate[:size:thin],
                np.maximum(peak, 10.0),
                lw=0.7,
                color=colour,
                label=label,
            )
        axis.axhline(threshold, color="black", lw=0.7, ls=":")
        axis.set_xlabel(labels[first.kind] + as_written(first.roll))
        axis.set_ylabel("error explained", fontsize=8)
        axis.grid(alpha=0.3)
        axis.yaxis.set_minor_formatter(NullFormatter())
    axes[0].legend(fontsize=8)
    figure.tight_layout()
    return svg(figure)


def channels_by_error(judged: Evaluation) -> list[int]:
    """Return indices of channels by the declared line's error over noise; no angle or radius.

    Largest first. An angle or a radius adds up what a speed shows: its error says nothing more.
    """
    ratio = judged.before / np.maximum(judged.floor, 1e-12)
    kept = [int(k) for k in np.argsort(-ratio) if not judged.channels[k].endswith(("rad", "_m"))]
    return kept or [0]


def wavenumber_map(judged: Evaluation, sample_time_s: float) -> str:
    """Return the residual's short spectra over web travel, before and after, on one channel.

    A roller shows at 1 / (2 pi R) at every speed; a roll drifts as its radius changes. Colours
    go from 6 dB below the noise floor to 30 dB above it.
    """
    at, travel_m = channels_by_error(judged)[0], judged.travel_m
    step_m = float(np.max(np.gradient(travel_m)))
    grid = np.arange(travel_m[0], travel_m[-1], max(step_m, 1e-9))
    size = max(16, min(512, grid.size // 4))
    starts = np.arange(0, grid.size - size, max(1, size // 4))
    centre = np.interp(grid[starts] + 0.5 * size * step_m, travel_m, np.arange(travel_m.size))
    wavenumber = np.fft.rfftfreq(size, step_m)
    keep = wavenumber <= HIGHEST_HZ * sample_time_s / step_m
    figure = Figure(figsize=(11, 3.2))
    axes = figure.subplots(1, 2, sharey=True)
    for axis, model, title in (
        (axes[0], judged.declared, "before"),
        (axes[1], judged.amended, "after"),
    ):
        residual = np.interp(grid, travel_m, judged.measured[at] - model[at])
        parts = np.stack([residual[s : s + size] for s in starts])
        parts = (parts - parts.mean(axis=1, keepdims=True)) * np.hanning(size)
        level = 20.0 * np.log10(np.abs(np.fft.rfft(parts, axis=1)).T + 1e-12)
        floor = 20.0 * np.log10(judged.floor[at] * np.sqrt(size) + 1e-12)
        axis.pcolormesh(
            centre * sample_time_s,
            wavenumber[keep],
            level[keep],
            vmin=floor - 6.0,
            vmax=floor + 30.0,
            cmap="magma",
            shading="nearest",
            rasterized=True,
        )
        axis.set_title(f"{as_written(judged.channels[at])}, {title}", fontsize=9)
        axis.set_xlabel("time [s]")
    axes[0].set_ylabel("1/m of web")
    return svg(figure)
