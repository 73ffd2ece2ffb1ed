"""How large a sum of orders can get over a turn: closer than the sum of its amplitudes."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
POINTS_PER_ORDER = 8


class PeakBound:
    """Bounds of the value and the slew of Re sum_n c_n e^{j n theta} for any later angle.

    The orders of the own roll form one waveform, sampled around the turn. A trigonometric
    polynomial of degree n never exceeds its largest sample of N > 2 n by more than
    1 / cos(pi n / N) (Ehlich and Zeller). Orders of other rolls add their amplitudes.
    """

    __slots__ = ("_at", "_extra", "_order", "_own", "_points", "_slack", "_spectrum")

    def __init__(self, order: Floats, roll_of: Sequence[str], own: str) -> None:
        mine = np.array([roll == own for roll in roll_of])
        self._order = order
        self._own = mine
        self._at = order[mine].astype(np.intp)
        highest = int(self._at.max(initial=1))
        points = 1 << math.ceil(math.log2(POINTS_PER_ORDER * highest))
        self._points = points
        self._slack = 1.0 / math.cos(math.pi * highest / points)
        self._spectrum = np.zeros((2, points // 2 + 1), dtype=np.complex128)
        self._extra = not mine.all()

    def of(self, parts: npt.NDArray[np.complex128], omega_rad_s: Floats) -> tuple[float, float]:
        """Return bounds of value and slew for terms ``parts`` at speeds ``omega_rad_s``."""
        turning = self._order * omega_rad_s
        own = parts[self._own]
        spectrum = self._spectrum
        spectrum[:] = 0.0
        # an imbalance shares order 1 with the shape
        np.add.at(spectrum[0], self._at, own)
        np.add.at(spectrum[1], self._at, own * (1j * turning[self._own]))
        wave = np.fft.irfft(spectrum, self._points, axis=1)
        scale = 0.5 * self._points * self._slack
        high, low = wave.max(axis=1), wave.min(axis=1)
        peak = scale * max(float(high[0]), -float(low[0]))
        slew = scale * max(float(high[1]), -float(low[1]))
        if self._extra:
            rest = np.abs(parts[~self._own])
            peak += float(rest.sum())
            slew += float(rest @ np.abs(turning[~self._own]))
        return peak, slew
