"""The noise a perfect model would leave: simulated from the declaration, checked on the data."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_toeplitz
from scipy.signal import lfilter

from sim_plant.base.arrays import Array

AR_ORDER = 24
CLEARLY_NOISIER = 1.06
SETTLING_S = 20.0
"""Judged from here on: the start state of a record is unknown (pull-roll zone: about 10 s)."""


def first_judged(samples: int, sample_time_s: float) -> int:
    """Return the first sample to judge: 20 s, or a quarter of a short record."""
    return min(round(SETTLING_S / sample_time_s), samples // 4)


def whitening_filter(noise: Array, order: int = AR_ORDER) -> tuple[Array, float]:
    """Return prediction-error taps (order + 1,) and innovation sd of noise (runs, samples).

    Equation: Yule-Walker, R a = r, with a ridge of 1e-6 R(0)  [Hayes 1996, 3.6].
    """
    centred = noise - noise.mean(axis=1, keepdims=True)
    length = centred.shape[1]
    size = 1 << (2 * length - 1).bit_length()
    power = np.abs(np.fft.rfft(centred, size, axis=1)) ** 2
    lags = np.fft.irfft(power, size, axis=1)[:, : order + 1].mean(axis=0) / length
    if lags[0] <= 0.0:
        return np.array([1.0]), 0.0
    ridge = lags.copy()
    ridge[0] *= 1.0 + 1e-6
    weights = solve_toeplitz(ridge[:-1], ridge[1:])
    variance = float(lags[0] - weights @ lags[1:])
    return np.concatenate(([1.0], -weights)), float(np.sqrt(max(variance, 1e-12 * lags[0])))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class NoiseModel:
    """Per channel: prediction-error filter, innovation sd, and rms of the noise itself.

    Attributes
    ----------
    filters : coefficient rows, one per channel.
    sd : innovation sd per channel (channels,), channel units.
    floor : rms of the noise per channel (channels,), the residual of a perfect model.
    first : first judged sample.
    """

    filters: tuple[Array, ...]
    sd: Array
    floor: Array
    first: int

    def whiten(self, values: Array) -> Array:
        """Return unit-variance innovations (channels, judged) of (channels, samples)."""
        out = np.empty((values.shape[0], values.shape[1] - self.first))
        for c, taps in enumerate(self.filters):
            start = max(0, self.first - taps.size)
            row = lfilter(taps, [1.0], values[c, start:])
            out[c] = row[self.first - start :] / self.sd[c]
        return out

    def scaled(self, factors: Array) -> NoiseModel:
        """Return the same shape of noise at ``factors`` (channels,) times the level."""
        return NoiseModel(
            filters=self.filters, sd=self.sd * factors, floor=self.floor * factors,
            first=self.first,
        )  # fmt: skip


def noise_model(runs: Array, first: int, coarse_steps: Array) -> NoiseModel:
    """Return the noise model of noise realisations (runs, channels, samples).

    ``coarse_steps`` (channels,) is the quantum of channels whose error is a slow sawtooth
    (a radius word): they count as one sample per quantum passed; 0 elsewhere.
    """
    filters, sd, floor = [], [], []
    for c in range(runs.shape[1]):
        noise = runs[:, c, first:]
        floor.append(float(np.sqrt(np.mean(noise**2))))
        if coarse_steps[c] > 0.0:
            floor[-1] = float(coarse_steps[c] / np.sqrt(12.0))
            filters.append(np.array([1.0]))
            sd.append(8.0 * floor[-1])
            continue
        taps, innovation = whitening_filter(noise)
        filters.append(taps)
        sd.append(max(innovation, 1e-12))
    return NoiseModel(
        filters=tuple(filters), sd=np.array(sd), floor=np.array(floor), first=first
    )  # fmt: skip


def measured_scale(whitened: Array) -> Array:
    """Return how much noisier the data are than declared, per channel, at least 1.

    Judged in the upper half of the band by the median, where effects of rollers do not reach.
    """
    power = np.abs(np.fft.rfft(whitened, axis=1)) ** 2 / whitened.shape[1]
    upper = power[:, power.shape[1] // 2 :]
    scale = np.sqrt(np.median(upper, axis=1) / np.log(2.0))
    return np.where(scale > CLEARLY_NOISIER, scale, 1.0)
