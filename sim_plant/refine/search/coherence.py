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
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.fit.objective import Objective

UNEXPLAINED = CRITERIA.search.unexplained
WINDOW_SHARE = 2.0 / 3.0
"""Independent bins per bin under a Hann window."""

CrossPower = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, kw_only=True)
class Coupling:
    """Two channels that move together otherwise than noise does.

    ``score`` is about exponential with mean 1 where noise is all there is.
    """

    channels: tuple[str, str]
    from_Hz: float
    to_Hz: float
    score: float


NO_COUPLING = Coupling(channels=("", ""), from_Hz=0.0, to_Hz=0.0, score=0.0)
"""Stands for none: any other has a higher score."""


def least_likely_coupling(objective: Objective, fit: Fit) -> Coupling:
    """Return the pair of channels and the band that are least like the declared noise."""
    couplings = [NO_COUPLING]
    rows = zip(
        objective.pool.twins,
        objective.whitening.noise,
        objective.whitening.realisations,
        objective.split(fit.residual),
        strict=True,
    )
    for twin, noise, realisations, part in rows:
        use = np.flatnonzero(noise.analogue)
        names = [twin.channels[c] for c in use]
        runs = [noise.whiten(run)[use] for run in realisations]
        couplings.append(least_likely_pair(part[use], runs, names, twin.declaration.sample_time_s))
    return max(couplings, key=lambda c: c.score)


def least_likely_pair(
    left: Array, noise: Sequence[Array], channels: Sequence[str], sample_time_s: float
) -> Coupling:
    """Return the pair of channels, and its band, least likely to be noise in one record.

    ``left`` (channels, samples) is what a fit leaves; ``noise`` are realisations of noise alone
    (channels, samples), whitened by the same filters.

    Equation: S = n |g - g0|^2 / (1 - |g0|^2), g the complex coherence of the n independent bins
    of a band, g0 that of the noise   [exponential for g = g0, n large].
    """
    nyquist_Hz, best = 0.5 / sample_time_s, NO_COUPLING
    for low_Hz, high_Hz in itertools.pairwise(UNEXPLAINED.coupling_bands_Hz):
        if high_Hz > nyquist_Hz:
            break
        low, high = low_Hz / nyquist_Hz, high_Hz / nyquist_Hz
        bins = round((high - low) * (left.shape[1] // 2))
        if bins < UNEXPLAINED.fewest_bins:
            continue
        here = _coherence(_cross(left, low, high))
        usual = _coherence(np.mean([_cross(run, low, high) for run in noise], axis=0))
        free = np.maximum(1.0 - np.abs(usual) ** 2, 1e-3)
        score = WINDOW_SHARE * bins * np.abs(here - usual) ** 2 / free
        one, other = divmod(int(np.argmax(np.triu(score, 1))), score.shape[1])
        if score[one, other] > best.score:
            best = Coupling(
                channels=(channels[one], channels[other]),
                from_Hz=low_Hz,
                to_Hz=high_Hz,
                score=float(score[one, other]),
            )
    return best


def _cross(values: Array, low: float, high: float) -> CrossPower:
    """Return the cross power (channels, channels) of a band of (channels, samples).

    ``low`` and ``high`` are shares of half the sample rate.
    """
    window = np.hanning(values.shape[1])
    spectrum = np.fft.rfft((values - values.mean(axis=1, keepdims=True)) * window, axis=1)
    edges = np.round(np.array([low, high]) * (values.shape[1] // 2)).astype(int) + 1
    part = spectrum[:, edges[0] : edges[1]]
    found: CrossPower = part @ part.conj().T
    return found


def _coherence(cross: CrossPower) -> CrossPower:
    """Return the complex coherence (channels, channels) of a cross power."""
    size = np.sqrt(np.maximum(np.real(np.diag(cross)), 1e-300))
    found: CrossPower = cross / np.outer(size, size)
    return found
