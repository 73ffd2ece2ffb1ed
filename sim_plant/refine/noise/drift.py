"""Slow drift of the noise, which a short prediction filter cannot hold.

Where no loop holds a tension, what the drives' noise and coarse words add to the web stays in the
zone until the web has left it: seconds, against a quarter of a second that the filter remembers.
A steady difference there is worth far less than its samples say.
"""

from __future__ import annotations

import itertools

import numpy as np
from scipy.fft import dct, idct

from sim_plant.base.arrays import Array

SLOW = 32
"""Slowest cosines looked at: up to 0.4 Hz in a record of 40 s."""
OCTAVES = (0, 1, 2, 4, 8, 16, SLOW)


def slow_cosines(white: Array) -> Array:
    """Return the sizes of the slowest cosines (..., ``SLOW``) of innovations (..., samples).

    Equation: DCT-II, orthonormal  [Ahmed, Natarajan, Rao 1974].
    """
    found: Array = dct(white, norm="ortho")[..., :SLOW]
    return found


def drift_standard_deviations(white: Array) -> Array:
    """Return the sd of every slow cosine (channels, ``SLOW``), at least 1, in whitened noise.

    ``white`` (runs, channels, samples) would have 1 everywhere were it white. Octaves share their
    level: few runs tell few numbers.
    """
    power = np.mean(slow_cosines(white) ** 2, axis=0)
    for low, high in itertools.pairwise(OCTAVES):
        power[:, low:high] = power[:, low:high].mean(axis=1, keepdims=True)
    sd: Array = np.sqrt(np.maximum(power, 1.0))
    return sd


def drift_whitened(white: Array, sd: Array) -> Array:
    """Return innovations (channels, samples) with their slow cosines at unit size."""
    excess = slow_cosines(white) * (1.0 - 1.0 / sd)
    rest: Array = white - idct(excess, n=white.shape[1], norm="ortho")
    return rest
