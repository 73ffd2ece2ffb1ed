"""How loud a probe has to be, and how loud it may be."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]
WANTED_ERROR = 0.2
"""One standard error of P over P: arg P is then known to 22 degrees, of 60 that may be."""
HEARD_ERROR = 0.61
"""Beyond it arg P is not known to 60 degrees, and an order rests (ADR 0039)."""
WANTED_SHARE = 0.9
"""Of the tones of orders; a line hardly answers at some frequency, and nothing helps there."""
HEARD_SHARE = 0.5
ROOM = 0.8
"""Of the bound that the tones are to move a signal by: what was measured of it has an error."""
FIRST_SHARE = 1.0 / 16.0
"""Of the bound where nothing is known of the line's answer."""
STEEPEST = 4.0
"""Times louder at most from one step to the next: a noisy step predicts the next one badly."""

NEIGHBOURS, CLEAR = 2, 2.0
"""Tones to both sides that are looked at with one, and standard deviations of their noise."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Heard:
    """What is known of the line's answer to one wave before it is played for long.

    Attributes
    ----------
    sizes : amplitude of each tone when the wave's peak is 1.
    answers : P at each tone; NaN or zero where it has not been heard.
    noise : E|n|^2 of what the fit of each tone will be off by in the whole record.
    counts : which tones stand where orders do, or will.
    """

    sizes: Floats
    answers: Complexes
    noise: Floats
    counts: npt.NDArray[np.bool_]

    def needed(self) -> float:
        """Return the peak at which nine tenths of the orders' tones are known well enough."""
        return self._peak_for(WANTED_ERROR, WANTED_SHARE)

    def least(self) -> float:
        """Return the peak below which more than half of them would be lost in noise."""
        return self._peak_for(HEARD_ERROR, HEARD_SHARE)

    def sure(self, peak: float) -> int:
        """Return how many of them are known to 60 degrees at a peak."""
        return int((self._errors(peak) <= HEARD_ERROR).sum())

    def _errors(self, peak: float) -> Floats:
        heard = np.abs(self.answers * self.sizes)[self.counts] * peak
        found = np.full(heard.size, math.inf)
        seen = heard > 0.0
        found[seen] = np.sqrt(self.noise[self.counts][seen]) / heard[seen]
        return found

    def _peak_for(self, error: float, share: float) -> float:
        """Return the peak at which a share of the tones has an error; infinite where none can."""
        errors = np.sort(self._errors(1.0))
        if not errors.size:
            return 0.0
        return float(errors[math.ceil(share * errors.size) - 1]) / error


def unbiased(seen: Complexes, noise: Floats) -> Complexes:
    """Return phasors without what noise adds to their size; zero where noise explains them.

    Powers are means over the two neighbours to both sides: one tone says little of itself while
    it is as small as the noise, and those that noise made large would pass for heard.
    """
    kernel = np.ones(2 * NEIGHBOURS + 1)
    if seen.size < kernel.size:
        kernel = np.ones(1)
    counted = np.convolve(np.ones(seen.size), kernel, "same")
    beyond = np.convolve(np.abs(seen) ** 2 - noise, kernel, "same") / counted
    spread = np.convolve(noise, kernel, "same") / counted / np.sqrt(counted)
    power = np.where(beyond > CLEAR * spread, beyond, 0.0)
    size = np.maximum(np.abs(seen), 1e-300)
    return np.asarray(seen / size * np.sqrt(power))


def allowed(levels: Sequence[float], moved: Floats, bounds: Sequence[float]) -> list[float]:
    """Return peaks turned down together until no signal moves beyond its room.

    Parameters
    ----------
    levels : peak of every wave.
    moved : (signals, waves) by how much a signal moves at a peak of 1.
    bounds : of every signal, infinite for none.
    """
    total = moved @ np.asarray(levels)
    shares = [
        ROOM * bound / one if one > 0.0 else math.inf
        for one, bound in zip(total, bounds, strict=True)
    ]
    share = min(1.0, *shares)
    return [share * level for level in levels]


def peak_of(answers: Complexes, at: npt.NDArray[np.int64], period: int) -> float:
    """Return the largest value of a sum of tones, each at ``at`` turns in ``period`` samples."""
    lines = np.zeros(period // 2 + 1, dtype=np.complex128)
    lines[at] = 0.5 * period * answers
    return float(np.abs(np.fft.irfft(lines, period)).max())
