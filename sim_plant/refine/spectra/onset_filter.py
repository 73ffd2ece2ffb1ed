"""A matched filter over the moment at which something begins."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import fft

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.twin import Twin

EVENTS = CRITERIA.search.events


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Axis:
    """Where moments of one record lie: seconds, or metres of unstretched web unwound.

    Attributes
    ----------
    moments : per judged sample (samples,).
    grid : equal steps between the first and the last of them.
    """

    moments: Array
    grid: Array

    @property
    def step(self) -> float:
        """Distance of two points of the grid."""
        return float(self.grid[1] - self.grid[0])


def moment_axis(twin: Twin, first: int, unit: str) -> Axis:
    """Return the axis of moments, s or m, of a record judged from the sample ``first`` on."""
    sample_s = twin.declaration.sample_time_s
    moments: Array = np.arange(twin.speed_m_s.size, dtype=np.float64) * sample_s
    if unit == "m":
        strain = twin.declaration.web.wound_in_tension_N / twin.declaration.web.EA_N
        moments = np.cumsum(np.abs(twin.speed_m_s)) * sample_s / (1.0 + strain)
    judged: Array = moments[first:]
    grid: Array = np.linspace(judged[0], judged[-1], judged.size)
    return Axis(moments=judged, grid=grid)


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    """A part of an axis in which one response, begun at ``middle``, stands for all moments."""

    low: float
    middle: float
    high: float


def parts_of(axis: Axis) -> list[Part]:
    """Return the parts of a record for which a response is simulated."""
    ends = np.linspace(axis.grid[0], axis.grid[-1], EVENTS.response_moments + 1)
    return [
        Part(low=low, middle=0.5 * (high + low), high=high)
        for low, high in zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True)
    ]


def best_moments(
    axis: Axis, on_grid: Array, response: Array, part: Part, unit: str
) -> list[tuple[float, float]]:
    """Return (chi-square, moment) where a response fits best within a part of the record.

    ``on_grid`` (channels, grid) and ``response`` (channels, judged samples) are innovations.
    """
    scores = onset_scores(
        on_grid,
        resampled(response, axis.moments, axis.grid),
        int(np.searchsorted(axis.grid, part.middle)),
        round(EVENTS.window[unit] / axis.step),
    )
    scores[(axis.grid < part.low) | (axis.grid >= part.high)] = 0.0
    at = peaks(scores, round(EVENTS.apart / axis.step), EVENTS.most_peaks)
    return [(float(scores[k]), float(axis.grid[k])) for k in at]


def onset_scores(white: Array, response: Array, onset: int, window: int) -> Array:
    """Return, per sample, the chi-square that a response beginning there explains.

    ``white`` (channels, samples) are innovations; ``response`` the same of an effect that begins
    at the sample ``onset``, taken to be the same later or earlier, for ``window`` samples.
    0 where less than a tenth of its energy would lie in the record.
    Equation: (sum h w)^2 / sum h^2 over channels and the samples there are  [matched filter].
    """
    samples = white.shape[1]
    template = response[:, onset : onset + window]
    size = fft.next_fast_len(samples + template.shape[1] - 1, real=True)
    product = fft.rfft(white, size) * fft.rfft(template[:, ::-1], size)
    against = fft.irfft(product, size).sum(axis=0)[template.shape[1] - 1 :][:samples]
    energy = np.cumsum(np.einsum("cs,cs->s", template, template))
    left = np.minimum(np.arange(samples, 0, -1), template.shape[1])
    inside = energy[left - 1]
    scores: Array = against**2 / np.maximum(inside, 1e-12 * max(float(energy[-1]), 1e-300))
    return np.where(inside > 0.1 * energy[-1], scores, 0.0)


def peaks(scores: Array, apart: int, most: int) -> list[int]:
    """Return the samples of the highest scores that are at least ``apart`` from each other."""
    left = scores.copy()
    highest: list[int] = []
    while len(highest) < most and left.max() > 0.0:
        at = int(np.argmax(left))
        highest.append(at)
        left[max(0, at - apart) : at + apart + 1] = 0.0
    return highest


def resampled(values: Array, coordinate: Array, grid: Array) -> Array:
    """Return ``values`` (channels, samples at ``coordinate``) interpolated at ``grid``."""
    return np.stack([np.interp(grid, coordinate, row) for row in values])


def later(change: Array, samples: int) -> Array:
    """Return a change (channels, n) begun ``samples`` later; below 0: earlier, its end kept."""
    moved = np.zeros_like(change)
    if samples >= 0:
        moved[:, samples:] = change[:, : change.shape[1] - samples]
    else:
        moved[:, :samples] = change[:, -samples:]
        moved[:, samples:] = change[:, -1:]
    return moved
