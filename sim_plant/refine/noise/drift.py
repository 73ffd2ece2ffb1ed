"""Slow drift of the noise, which a short prediction filter cannot describe.

Where no loop holds a tension, what the drives' noise and coarse words add to the web stays in the
zone until the web has left it: seconds, where the filter spans a quarter of a second. A steady
difference there proves far less than the number of its samples suggests.
"""

from __future__ import annotations

import itertools
from functools import lru_cache

import numpy as np

from sim_plant.base.arrays import Array

SLOW = 32
"""How many of the slowest cosines are looked at: up to 0.4 Hz in a record of 40 s."""
OCTAVES = (0, 1, 2, 4, 8, 16, SLOW)
"""Edges of the groups of cosines that share one level."""


@lru_cache(maxsize=8)
def cosines(samples: int) -> Array:
    """Return the slowest orthonormal cosines (``SLOW``, samples) of a record; kept per length.

    Equation: DCT-II, orthonormal  [Ahmed, Natarajan, Rao 1974].
    """
    half_turns = np.outer(np.arange(SLOW), np.arange(samples) + 0.5) / samples
    rows: Array = np.cos(np.pi * half_turns) * np.sqrt(2.0 / samples)
    rows[0] *= np.sqrt(0.5)
    rows.flags.writeable = False
    return rows


def slow_cosines(white: Array) -> Array:
    """Return the sizes of the slowest cosines (..., ``SLOW``) of innovations (..., samples)."""
    found: Array = white @ cosines(white.shape[-1]).T
    return found


def drift_standard_deviations(white: Array) -> Array:
    """Return the sd of every slow cosine (channels, ``SLOW``), at least 1, in whitened noise.

    ``white`` (simulations of noise alone, channels, samples) would have 1 everywhere were it
    white. Octaves share their level: few simulations tell few numbers.
    """
    power = np.mean(slow_cosines(white) ** 2, axis=0)
    for low, high in itertools.pairwise(OCTAVES):
        power[:, low:high] = power[:, low:high].mean(axis=1, keepdims=True)
    sd: Array = np.sqrt(np.maximum(power, 1.0))
    return sd


def drift_whitened(white: Array, sd: Array) -> Array:
    """Return innovations (..., channels, samples) with slow cosines of unit variance."""
    excess = slow_cosines(white) * (1.0 - 1.0 / sd)
    rest: Array = white - excess @ cosines(white.shape[-1])
    return rest
