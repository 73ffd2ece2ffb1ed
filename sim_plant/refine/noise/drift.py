"""Slow drift of the noise, which a short prediction filter cannot describe.

Where no loop holds a tension, what the drives' noise and coarse words add to the web stays in the
zone until the web has left it: seconds, where the filter spans a quarter of a second. A steady
difference there proves far less than the number of its samples suggests.
"""

from __future__ import annotations

import itertools

import numpy as np
from scipy.fft import dct, idct

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA

NOISE = CRITERIA.noise


def slow_terms(samples: int, sample_time_s: float) -> int:
    """Return how many of the slowest cosines are looked at in so many judged samples.

    Cosine m has m half waves in the record, m / (2 T) Hz in T seconds: 32 of them end at 0.4 Hz in
    40 s and at 0.27 Hz in 60 s. From there on every second brings the 0.8 that end at 0.4 Hz.
    Equation: ``drift_terms`` + 2 ``drift_Hz`` max(0, T - ``drift_s``), at most half of
    the samples, or ``drift_terms`` where those are more  [own].
    """
    more = 2.0 * NOISE.drift_Hz * max(0.0, samples * sample_time_s - NOISE.drift_s)
    return min(NOISE.drift_terms + round(more), max(NOISE.drift_terms, samples // 2))


def octaves(terms: int) -> tuple[int, ...]:
    """Return the edges of groups of cosines that share one level: 0, 1, 2, 4, ... ``terms``.

    The last group has half an octave at the least.
    """
    edges = [0, 1]
    while 3 * edges[-1] <= terms:
        edges.append(2 * edges[-1])
    return (*edges, terms)


def slow_cosines(white: Array, terms: int) -> Array:
    """Return the sizes of the slowest cosines (..., terms) of innovations (..., samples).

    Equation: DCT-II, orthonormal  [Ahmed, Natarajan, Rao 1974].
    """
    found: Array = dct(white, type=2, norm="ortho")[..., :terms]
    return found


def drift_standard_deviations(white: Array, terms: int) -> Array:
    """Return the sd of every slow cosine (channels, terms), at least 1, in whitened noise.

    ``white`` (simulations of noise alone, channels, samples) would have 1 everywhere were it
    white. Octaves share their level: few simulations tell few numbers.
    """
    power = np.mean(slow_cosines(white, terms) ** 2, axis=0)
    for low, high in itertools.pairwise(octaves(terms)):
        power[:, low:high] = power[:, low:high].mean(axis=1, keepdims=True)
    sd: Array = np.sqrt(np.maximum(power, 1.0))
    return sd


def drift_whitened(white: Array, sd: Array) -> Array:
    """Return innovations (..., channels, samples) with slow cosines of unit variance.

    ``sd`` (channels, terms) are those of ``drift_standard_deviations``.
    """
    cosines = dct(white, type=2, norm="ortho")
    cosines[..., : sd.shape[-1]] /= sd
    rest: Array = idct(cosines, type=2, norm="ortho")
    return rest
