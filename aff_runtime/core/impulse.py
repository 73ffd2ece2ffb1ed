"""P as an impulse response, from measured points or a declared line: filtered-x needs it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from aff_runtime.base.errors import ConfigError
from aff_runtime.core.response import Response

Floats = npt.NDArray[np.float64]
DECAY_S = 1.0
"""Time constant with which the taps' variance decays a priori."""
POINTS = 160
"""Frequencies, at least, at which the measured curve is read."""
MIN_ERROR = 0.01
"""Added to the relative error of every frequency."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopModel:
    """Impulse responses of one actuator to one signal, by roll radius.

    Attributes
    ----------
    radius_m : (r,), rising; one entry when the response was measured at one radius only.
    taps : (r, length); tap i is what a value of 1 in tick k adds to the signal in tick k + 1 + i.
    """

    radius_m: Floats
    taps: Floats

    def at(self, radius_m: float) -> Floats:
        """Return the taps at a radius, linear between the known ones, (length,)."""
        known = self.radius_m
        if known.size == 1 or not math.isfinite(radius_m):
            return np.asarray(self.taps[0])
        i = min(max(int(np.searchsorted(known, radius_m)) - 1, 0), known.size - 2)
        share = (radius_m - known[i]) / (known[i + 1] - known[i])
        share = min(1.0, max(0.0, share))
        return np.asarray((1.0 - share) * self.taps[i] + share * self.taps[i + 1])

    def response(self, frequency_Hz: float, cycle_s: float, radius_m: float) -> complex:
        """Return P at a frequency, in the convention of ``Response``."""
        taps = self.at(radius_m)
        turns = np.arange(1, taps.size + 1) * (frequency_Hz * cycle_s)
        return complex(taps @ np.exp(-2j * math.pi * turns))


def from_taps(radius_m: Sequence[float], taps: Sequence[Floats]) -> LoopModel:
    """Return the model of impulse responses known by radius (m).

    Raises
    ------
    ConfigError
        When there is none, they differ in length or the radii do not rise.
    """
    radii = np.asarray(radius_m, dtype=np.float64)
    if len(taps) == 0 or len({t.size for t in taps}) != 1 or len(taps) != radii.size:
        raise ConfigError("a loop model needs one impulse response of equal length per radius")
    if np.any(np.diff(radii) <= 0.0) or not all(np.isfinite(t).all() for t in taps):
        raise ConfigError("the radii of a loop model must rise, its taps must be finite")
    return LoopModel(radius_m=radii, taps=np.vstack(taps))


def from_response(response: Response, *, cycle_s: float, memory_s: float) -> LoopModel:
    """Return the impulse response that explains measured points best.

    Kernel-based identification: taps are a priori a decaying random walk (the "tuned/correlated"
    kernel lambda^max(i, j)), the points are linear in them, so the most likely taps follow from
    one linear system. Between points the measured curve itself stands in, with an error that
    grows outside the band and with the points' own; a frequency of zero answers nothing, because
    the tension loop integrates. The curve is read closely enough that a response
    of ``memory_s`` follows from it (``_frequencies``).

    Parameters
    ----------
    memory_s : length of the impulse response.
    """
    count = max(8, round(memory_s / cycle_s))
    low, high = response.band_Hz
    nyquist_Hz = 0.5 / cycle_s
    grid = _frequencies(max(0.02, 0.5 * low), min(1.5 * high, 0.8 * nyquist_Hz), memory_s)
    wanted = np.array([response.at(float(f)) for f in grid])
    outside = np.maximum(np.maximum(low / grid, grid / high), 1.0)
    known = np.interp(
        grid,
        [point.frequency_Hz for point in response.points],
        [point.relative_error for point in response.points],
    )
    error = (MIN_ERROR + known + np.log2(outside)) * np.abs(wanted)
    ticks = np.arange(1, count + 1)
    turn = np.exp(-2j * math.pi * grid[:, None] * cycle_s * ticks[None, :])
    design = np.vstack([turn.real, turn.imag])
    target = np.concatenate([wanted.real, wanted.imag])
    prior = np.exp(-cycle_s / DECAY_S * np.maximum.outer(ticks, ticks))
    prior *= float(np.max(np.abs(wanted))) ** 2 * (math.tau * low * cycle_s)
    spread = design @ prior
    noise = np.tile(error**2, 2)
    taps = spread.T @ np.linalg.solve(spread @ design.T + np.diag(noise), target)
    return LoopModel(radius_m=np.array([math.nan]), taps=taps[None, :])


def _frequencies(low_Hz: float, high_Hz: float, memory_s: float) -> Floats:
    """Return evenly spread frequencies, twice as close as a response of that length needs.

    What lasts T is known from its transform at every 1/T (the sampling theorem with time and
    frequency exchanged). Wider apart, taps beyond that time are free to be wrong in between.
    """
    closest = 0.5 / memory_s
    count = max(POINTS, math.ceil((high_Hz - low_Hz) / closest) + 1)
    return np.linspace(low_Hz, high_Hz, count)
