"""Slow wander of the noise, which a short prediction filter cannot hold.

Where no loop holds a tension, what the drives' noise and coarse words add to the web stays in the
zone until the web has left it: seconds, against a quarter of a second that the filter remembers.
A steady difference there is worth far less than its samples say.
"""

from __future__ import annotations

import itertools
from functools import lru_cache

import numpy as np

from sim_plant.base.arrays import Array

SLOW = 32
"""Slowest cosines looked at: up to 0.4 Hz in a record of 40 s."""
OCTAVES = (0, 1, 2, 4, 8, 16, SLOW)


@lru_cache(maxsize=8)
def slow_cosines(samples: int) -> Array:
    """Return the slowest cosines over a record (samples, ``SLOW``), orthonormal.

    Equation: DCT-II, cos(pi m (t + 1/2) / n)  [Ahmed, Natarajan, Rao 1974].
    """
    order, at = np.arange(SLOW), np.arange(samples) + 0.5
    terms = np.cos(np.pi * np.outer(at, order) / samples) * np.sqrt(2.0 / samples)
    terms[:, 0] /= np.sqrt(2.0)
    return np.asarray(terms)


def drift_standard_deviations(whitened: Array) -> Array:
    """Return the sd of every slow cosine (channels, ``SLOW``), at least 1, in whitened noise.

    ``whitened`` (runs, channels, samples) would have 1 everywhere were it white. Octaves share
    their level: few runs tell few numbers.
    """
    power = np.mean((whitened @ slow_cosines(whitened.shape[2])) ** 2, axis=0)
    for low, high in itertools.pairwise(OCTAVES):
        power[:, low:high] = power[:, low:high].mean(axis=1, keepdims=True)
    sd: Array = np.sqrt(np.maximum(power, 1.0))
    return sd


def drift_whitened(white: Array, sd: Array) -> Array:
    """Return innovations (channels, samples) with their slow cosines at unit size."""
    terms = slow_cosines(white.shape[1])
    rest: Array = white - ((white @ terms) * (1.0 - 1.0 / sd)) @ terms.T
    return rest
