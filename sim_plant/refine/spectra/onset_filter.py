"""A matched filter over the moment at which something begins."""

from __future__ import annotations

import numpy as np
from scipy import fft

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.spectra.moment_axis import MomentAxis, Part, resampled

EVENTS = CRITERIA.search.events


def best_moments(
    axis: MomentAxis, on_grid: Array, response: Array, part: Part, unit: str
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
    0 where less than ``least_energy_share`` of its energy would lie in the record.
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
    return np.where(inside > EVENTS.least_energy_share * energy[-1], scores, 0.0)


def peaks(scores: Array, apart: int, most: int) -> list[int]:
    """Return the samples of the highest scores that are at least ``apart`` from each other."""
    left = scores.copy()
    highest: list[int] = []
    while len(highest) < most and left.max() > 0.0:
        at = int(np.argmax(left))
        highest.append(at)
        left[max(0, at - apart) : at + apart + 1] = 0.0
    return highest
