"""The report's plots as inline SVG."""

from __future__ import annotations

from collections.abc import Sequence
from math import nan

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from aff_runtime.base.channel_units import unit_of_name, without_unit
from sim_plant.base.arrays import Array
from sim_plant.base.svg import as_written, svg
from sim_plant.refine.judge.holdout import Evaluation
from sim_plant.refine.judge.refutation import STATES
from sim_plant.refine.spectra.spectral_lines import SpectralLines

DECLARED, AMENDED, MEASURED = "#b3261e", "#1a7f37", "#9aa0a6"
"""Colours."""
POINTS = 3000
"""At least so many points are drawn of a longer spectrum, each the largest of its neighbours."""
SHOWN_S = 8.0
"""Length of what is drawn of a record where the declared line is worst."""
MOST_CHANNELS = 3
"""Channels that are drawn of a record."""
LEAST_EXPLAINED = 10.0
"""Smaller chi-square reductions are drawn as this: their axis is a logarithm."""
AROUND_MOMENT_S, LEAD_SHARE = 20.0, 0.25
"""Length of what is drawn around a moment, for web that takes its time to pass the line; and the
share of it that leads up to that moment."""
HIGHEST_HZ = 15.0
"""Highest frequency of the map over web travel, at the highest speed of the record."""
BELOW_FLOOR_DB, ABOVE_FLOOR_DB = 6.0, 30.0
"""The map's colours begin that far below the noise floor and end that far above it."""


def overlay(
    judged: Evaluation,
    sample_time_s: float,
    part: slice,
    *,
    draw_amended: bool = True,
    mark_s: float = nan,
) -> tuple[str, str]:
    """Return measured against declared and amended, and the error of both, as two plots.

    Of the channels of `shown_channels`, in this ``part`` of the record (samples).

    Parameters
    ----------
    draw_amended : the amended line is another one than the declared: both are drawn.
    mark_s : a moment to mark; NaN: none.
    """
    show = shown_channels(judged)
    figures = [Figure(figsize=(6, 2.3 * len(show))) for _ in range(2)]
    columns = [
        figure.subplots(len(show), 1, sharex=True, squeeze=False)[:, 0] for figure in figures
    ]
    time_s = (np.arange(judged.measured.shape[1]) * sample_time_s)[part]
    models = [(judged.declared, DECLARED, "declared"), (judged.amended, AMENDED, "amended")]
    for left, right, k in zip(*columns, show, strict=True):
        measured = judged.measured[k, part]
        left.plot(time_s, measured, color=MEASURED, lw=2.0, label="measured")
        for model, colour, label in models if draw_amended else models[:1]:
            error = f"error as {label}"
            style = "--" if label == "declared" and draw_amended else "-"
            left.plot(time_s, model[k, part], color=colour, lw=0.9, ls=style, label=label)
            off = measured - model[k, part]
            right.plot(time_s, off, color=colour, lw=0.8, ls=style, label=error)
        for panel in (left, right):
            panel.set_ylabel(as_written(_with_unit(judged.channels[k])), fontsize=8)
            panel.grid(alpha=0.3)
            if np.isfinite(mark_s):
                panel.axvline(mark_s, color="black", lw=0.9, ls=":")
    for figure, panels in zip(figures, columns, strict=True):
        panels[0].legend(
            loc="lower center", bbox_to_anchor=(0.5, 1.0), fontsize=8, ncols=3, frameon=False
        )
        panels[-1].set_xlabel("time [s]")
        figure.tight_layout()
    return svg(figures[0]), svg(figures[1])


def _with_unit(channel: str) -> str:
    """Return a channel as a label: ``unwind_tension [N]``."""
    unit = unit_of_name(channel)
    return f"{without_unit(channel)} [{unit}]" if unit else channel


def shown_channels(judged: Evaluation) -> list[int]:
    """Return the channels of the largest error as declared, a tension among them."""
    ranked = channels_by_error(judged)
    show = ranked[:MOST_CHANNELS]
    tensions = [k for k in ranked if judged.channels[k].endswith("_N")]
    if tensions and not set(tensions) & set(show):
        show = [*show[:-1], tensions[0]]
    return show


def worst_of(judged: Evaluation, sample_time_s: float) -> slice:
    """Return the samples of a record in which the declared line is worst, ``SHOWN_S`` of them."""
    samples = max(1, round(SHOWN_S / sample_time_s))
    return worst_part(judged, shown_channels(judged)[0], samples)


def part_around(judged: Evaluation, sample_time_s: float, moment_s: float) -> slice:
    """Return the samples of a record around a moment, most of them after it."""
    size, samples = round(AROUND_MOMENT_S / sample_time_s), judged.measured.shape[1]
    start = round((moment_s - LEAD_SHARE * AROUND_MOMENT_S) / sample_time_s)
    start = max(0, min(start, samples - size))
    return slice(start, min(samples, start + size))


def worst_part(
    judged: Evaluation, channel: int, samples: int, simulated: Array | None = None
) -> slice:
    """Return the ``samples`` judged samples in which a simulated line is furthest off.

    ``simulated`` (channels, samples) is of that line; None: of the line as declared.
    """
    model = judged.declared if simulated is None else simulated
    squared = (judged.measured[channel] - model[channel])[judged.first :] ** 2
    samples = min(samples, squared.size)
    total = np.concatenate(([0.0], np.cumsum(squared)))
    start = judged.first + int(np.argmax(total[samples:] - total[:-samples]))
    return slice(start, start + samples)


def spectrum(
    declared_spectra: Sequence[SpectralLines],
    amended_spectra: Sequence[SpectralLines],
    threshold: float,
    *,
    draw_amended: bool = True,
) -> str:
    """Return what a free spectral line explains in time, travel and roll angle, chi-square."""
    figure = Figure(figsize=(11, 2.6 * len(declared_spectra)))
    panels = np.atleast_1d(figure.subplots(len(declared_spectra), 1))
    texts = {"time": "Hz", "travel": "1/m of web", "angle": "times per turn of "}
    rows = zip(panels, declared_spectra, amended_spectra, strict=True)
    for panel, as_declared, as_amended in rows:
        both = ((as_declared, DECLARED, "declared"), (as_amended, AMENDED, "amended"))
        for drawn, colour, label in both if draw_amended else both[:1]:
            thin = max(1, drawn.chi2_reduction.size // POINTS)
            size = drawn.chi2_reduction.size // thin * thin
            peak = drawn.chi2_reduction[:size].reshape(-1, thin).max(axis=1)
            panel.semilogy(
                drawn.frequency[:size:thin],
                np.maximum(peak, LEAST_EXPLAINED),
                lw=0.7,
                color=colour,
                label=label,
            )
        panel.axhline(threshold, color="black", lw=0.7, ls=":")
        panel.set_xlabel(texts[as_declared.axis] + as_written(as_declared.roll))
        panel.set_ylabel("error explained", fontsize=8)
        panel.grid(alpha=0.3)
        panel.yaxis.set_minor_formatter(NullFormatter())
    if draw_amended:
        panels[0].legend(fontsize=8)
    figure.tight_layout()
    return svg(figure)


def channels_by_error(judged: Evaluation) -> list[int]:
    """Return indices of channels by the declared line's error over noise, the largest first.

    Without angles and radii; the first channel where nothing else is declared.
    """
    ratio = judged.rms_declared / np.maximum(judged.floor, 1e-12)
    kept = [int(k) for k in np.argsort(-ratio) if not is_angle_or_radius(judged.channels[k])]
    return kept or [0]


def is_angle_or_radius(channel: str) -> bool:
    """Return whether a channel is one: it adds up what a speed shows, its error says no more."""
    return channel.endswith(STATES)


def wavenumber_map(
    judged: Evaluation, sample_time_s: float, *, draw_amended: bool = True
) -> tuple[str, ...]:
    """Return the residual's short-time spectra over web travel, of the channel declared worst.

    One plot of the line as declared and, with ``draw_amended``, one as amended. A roller shows at
    1 / (2 pi R) at every speed; a roll drifts as its radius changes. Colours are decibels over
    the noise floor: of white noise with its rms, seen through the same window.
    """
    at, travel_m = channels_by_error(judged)[0], judged.travel_m
    step_m = float(np.max(np.gradient(travel_m)))
    grid = np.arange(travel_m[0], travel_m[-1], max(step_m, 1e-9))
    size = max(16, min(512, grid.size // 4))
    starts = np.arange(0, grid.size - size, max(1, size // 4))
    centre = np.interp(grid[starts] + 0.5 * size * step_m, travel_m, np.arange(travel_m.size))
    wavenumber = np.fft.rfftfreq(size, step_m)
    keep = wavenumber <= HIGHEST_HZ * sample_time_s / step_m
    window = np.hanning(size)
    floor = float(_decibels(judged.floor[at] * np.sqrt(np.sum(window**2))))
    maps = []
    both = ((judged.declared, "declared"), (judged.amended, "amended"))
    for model, title in both if draw_amended else both[:1]:
        figure = Figure(figsize=(6, 3.2))
        panel = figure.subplots()
        residual = np.interp(grid, travel_m, judged.measured[at] - model[at])
        parts = np.stack([residual[s : s + size] for s in starts])
        parts = (parts - parts.mean(axis=1, keepdims=True)) * window
        panel.pcolormesh(
            centre * sample_time_s,
            wavenumber[keep],
            _decibels(np.abs(np.fft.rfft(parts, axis=1)).T)[keep],
            vmin=floor - BELOW_FLOOR_DB,
            vmax=floor + ABOVE_FLOOR_DB,
            cmap="magma",
            shading="nearest",
            rasterized=True,
        )
        name = as_written(judged.channels[at])
        panel.set_title(f"{name}, {title}" if draw_amended else name, fontsize=9)
        panel.set_xlabel("time [s]")
        panel.set_ylabel("1/m of web")
        figure.tight_layout()
        maps.append(svg(figure))
    return tuple(maps)


def _decibels(amplitude: Array) -> Array:
    return 20.0 * np.log10(amplitude + 1e-12)
