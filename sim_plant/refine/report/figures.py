"""The report's figures as inline SVG."""

from __future__ import annotations

from collections.abc import Sequence
from math import nan

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from sim_plant.base.svg import as_written, svg
from sim_plant.refine.judge.holdout import Evaluation
from sim_plant.refine.spectra.spectral_lines import SpectralLines

BEFORE, AFTER, MEASURED = "#b3261e", "#1a7f37", "#9aa0a6"
POINTS = 3000
"""At least so many points are drawn of a longer spectrum, each the largest of its neighbours."""
SHOWN_S = 8.0
"""Length of what is drawn of a record where the declared line is worst."""
BEGUN_S, BEFORE_SHARE = 20.0, 0.25
"""Length of what is drawn around a moment, for web that takes its time to pass the line; and its
share before that moment."""
HIGHEST_HZ = 15.0
"""Highest frequency of the map over web travel, at the highest speed of the record."""


def overlay(
    judged: Evaluation,
    sample_time_s: float,
    part: slice,
    *,
    amended: bool = True,
    mark_s: float = nan,
) -> tuple[str, str]:
    """Return measured against declared and amended, and the error of both, as two figures.

    Of the channels of `shown_channels`, in this ``part`` of the record.

    Parameters
    ----------
    amended : the amended line is another one than the declared: both are drawn.
    mark_s : a moment to mark; NaN: none.
    """
    show = shown_channels(judged)
    figures = [Figure(figsize=(6, 2.3 * len(show))) for _ in range(2)]
    columns = [
        figure.subplots(len(show), 1, sharex=True, squeeze=False)[:, 0] for figure in figures
    ]
    time_s = (np.arange(judged.measured.shape[1]) * sample_time_s)[part]
    models = [(judged.declared, BEFORE, "declared"), (judged.amended, AFTER, "amended")]
    for left, right, k in zip(*columns, show, strict=True):
        measured = judged.measured[k, part]
        left.plot(time_s, measured, color=MEASURED, lw=2.0, label="measured")
        for model, colour, label in models if amended else models[:1]:
            error = f"error as {label}"
            left.plot(time_s, model[k, part], color=colour, lw=0.9, label=label)
            right.plot(time_s, measured - model[k, part], color=colour, lw=0.8, label=error)
        for axis in (left, right):
            axis.set_ylabel(as_written(judged.channels[k]), fontsize=8)
            axis.grid(alpha=0.3)
            if np.isfinite(mark_s):
                axis.axvline(mark_s, color="black", lw=0.9, ls=":")
    for figure, axes in zip(figures, columns, strict=True):
        axes[0].legend(
            loc="lower center", bbox_to_anchor=(0.5, 1.0), fontsize=8, ncols=3, frameon=False
        )
        axes[-1].set_xlabel("time [s]")
        figure.tight_layout()
    return svg(figures[0]), svg(figures[1])


def shown_channels(judged: Evaluation) -> list[int]:
    """Return the three channels with the largest error before, one of them a tension if any is."""
    ranked = channels_by_error(judged)
    show = ranked[:3]
    tensions = [k for k in ranked if judged.channels[k].endswith("_N")]
    if tensions and not set(tensions) & set(show):
        show = [*show[:2], tensions[0]]
    return show


def worst_of(judged: Evaluation, sample_time_s: float) -> slice:
    """Return the seconds of a record in which the declared line is worst."""
    samples = max(1, round(SHOWN_S / sample_time_s))
    return worst_part(judged, shown_channels(judged)[0], samples)


def part_around(judged: Evaluation, sample_time_s: float, moment_s: float) -> slice:
    """Return the seconds of a record around a moment, most of them after it."""
    size, rows = round(BEGUN_S / sample_time_s), judged.measured.shape[1]
    start = round((moment_s - BEFORE_SHARE * BEGUN_S) / sample_time_s)
    start = max(0, min(start, rows - size))
    return slice(start, min(rows, start + size))


def worst_part(judged: Evaluation, channel: int, samples: int) -> slice:
    """Return where the declared line is furthest off the measured, ``samples`` judged samples."""
    squared = (judged.measured[channel] - judged.declared[channel])[judged.first :] ** 2
    samples = min(samples, squared.size)
    total = np.concatenate(([0.0], np.cumsum(squared)))
    start = judged.first + int(np.argmax(total[samples:] - total[:-samples]))
    return slice(start, start + samples)


def spectrum(
    before: Sequence[SpectralLines],
    after: Sequence[SpectralLines],
    threshold: float,
    *,
    amended: bool = True,
) -> str:
    """Return what a free spectral line explains in time, travel and roll angle, chi-square."""
    figure = Figure(figsize=(11, 2.6 * len(before)))
    axes = np.atleast_1d(figure.subplots(len(before), 1))
    labels = {"time": "Hz", "travel": "1/m of web", "angle": "times per turn of "}
    for axis, first, last in zip(axes, before, after, strict=True):
        both = ((first, BEFORE, "before"), (last, AFTER, "after"))
        for drawn, colour, label in both if amended else both[:1]:
            thin = max(1, drawn.chi2_reduction.size // POINTS)
            size = drawn.chi2_reduction.size // thin * thin
            peak = drawn.chi2_reduction[:size].reshape(-1, thin).max(axis=1)
            axis.semilogy(
                drawn.frequency[:size:thin],
                np.maximum(peak, 10.0),
                lw=0.7,
                color=colour,
                label=label,
            )
        axis.axhline(threshold, color="black", lw=0.7, ls=":")
        axis.set_xlabel(labels[first.axis] + as_written(first.roll))
        axis.set_ylabel("error explained", fontsize=8)
        axis.grid(alpha=0.3)
        axis.yaxis.set_minor_formatter(NullFormatter())
    if amended:
        axes[0].legend(fontsize=8)
    figure.tight_layout()
    return svg(figure)


def channels_by_error(judged: Evaluation) -> list[int]:
    """Return indices of channels by the declared line's error over noise; no angle or radius.

    Largest first. An angle or a radius adds up what a speed shows: its error says nothing more.
    """
    ratio = judged.before / np.maximum(judged.floor, 1e-12)
    kept = [int(k) for k in np.argsort(-ratio) if not is_sum(judged.channels[k])]
    return kept or [0]


def is_sum(channel: str) -> bool:
    """Return whether a channel adds up what a speed shows: an angle or a radius."""
    return channel.endswith(("rad", "_m"))


def wavenumber_map(
    judged: Evaluation, sample_time_s: float, *, amended: bool = True
) -> tuple[str, ...]:
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
    maps = []
    both = ((judged.declared, "before"), (judged.amended, "after"))
    for model, title in both if amended else both[:1]:
        figure = Figure(figsize=(6, 3.2))
        axis = figure.subplots()
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
        name = as_written(judged.channels[at])
        axis.set_title(f"{name}, {title}" if amended else name, fontsize=9)
        axis.set_xlabel("time [s]")
        axis.set_ylabel("1/m of web")
        figure.tight_layout()
        maps.append(svg(figure))
    return tuple(maps)
