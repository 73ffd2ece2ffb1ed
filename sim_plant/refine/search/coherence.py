"""Whether channels move together as their declared noise does, band by band.

Noise of a cell goes through its loop into the drive's speed, so noise has a coupling of its own.
A push on the line itself (a drive that runs unevenly, a fluttering web) reaches the same channels
in other shares: it shows here long before it makes any channel louder than noise may be.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim_plant.base.arrays import Array
from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.fit.objective import Objective

BANDS = (1.0 / 80.0, 1.0 / 40.0, 1.0 / 20.0, 1.0 / 10.0, 1.0 / 5.0, 2.0 / 5.0)
"""Edges, share of half the sample rate: below, tolerances move channels together."""
FEWEST_BINS = 16
WINDOW_SHARE = 2.0 / 3.0
"""Independent bins per bin under a Hann window."""

Spectra = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, kw_only=True)
class Coupling:
    """Two channels that move together otherwise than noise does.

    ``score`` is about exponential with mean 1 where noise is all there is.
    """

    channels: tuple[str, str]
    from_Hz: float
    to_Hz: float
    score: float


def oddest_coupling(objective: Objective, fit: Fit) -> Coupling:
    """Return the pair of channels and the band that are least like the declared noise."""
    found = [Coupling(channels=("", ""), from_Hz=0.0, to_Hz=0.0, score=0.0)]
    rows = zip(
        objective.pool.twins,
        objective.noise,
        objective.noisy,
        objective.split(fit.residual),
        strict=True,
    )
    for twin, noise, noisy, part in rows:
        use = np.flatnonzero(noise.analogue)
        names = [twin.channels[c] for c in use]
        runs = [noise.whiten(run)[use] for run in noisy]
        found.append(_oddest_of_record(part[use], runs, names, twin.declaration.sample_time_s))
    return max(found, key=lambda c: c.score)


def _oddest_of_record(
    measured: Array, runs: Sequence[Array], names: Sequence[str], step_s: float
) -> Coupling:
    """Return the oddest pair of one record.

    Equation: S = n |g - g0|^2 / (1 - |g0|^2), g the complex coherence of the n independent bins
    of a band, g0 that of the noise   [exponential for g = g0, n large].
    """
    half_Hz, best = 0.5 / step_s, Coupling(channels=("", ""), from_Hz=0.0, to_Hz=0.0, score=0.0)
    for low, high in itertools.pairwise(BANDS):
        bins = round((high - low) * (measured.shape[1] // 2))
        if bins < FEWEST_BINS:
            continue
        here = _coherence(_cross(measured, low, high))
        usual = _coherence(np.mean([_cross(run, low, high) for run in runs], axis=0))
        free = np.maximum(1.0 - np.abs(usual) ** 2, 1e-3)
        score = WINDOW_SHARE * bins * np.abs(here - usual) ** 2 / free
        one, other = divmod(int(np.argmax(np.triu(score, 1))), score.shape[1])
        if score[one, other] > best.score:
            best = Coupling(
                channels=(names[one], names[other]),
                from_Hz=low * half_Hz,
                to_Hz=high * half_Hz,
                score=float(score[one, other]),
            )
    return best


def _cross(values: Array, low: float, high: float) -> Spectra:
    """Return the cross power (channels, channels) of a band of (channels, samples)."""
    window = np.hanning(values.shape[1])
    spectrum = np.fft.rfft((values - values.mean(axis=1, keepdims=True)) * window, axis=1)
    edges = np.round(np.array([low, high]) * (values.shape[1] // 2)).astype(int) + 1
    part = spectrum[:, edges[0] : edges[1]]
    found: Spectra = part @ part.conj().T
    return found


def _coherence(cross: Spectra) -> Spectra:
    size = np.sqrt(np.maximum(np.real(np.diag(cross)), 1e-300))
    found: Spectra = cross / np.outer(size, size)
    return found
