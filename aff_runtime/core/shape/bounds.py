"""How large a sum of orders can get over a turn: closer than the sum of its amplitudes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
POINTS_PER_ORDER = 16  # samples around the turn, per unit of the highest order


class PeakBound:
    """Bounds of the value and the slew of Re sum_n c_n e^{j n theta} for any later angle.

    The orders of the own roll form one waveform, sampled around the turn. A trigonometric
    polynomial of degree n never exceeds its largest sample of N > 2 n by more than
    1 / cos(pi n / N) [Ehlich, Zeller 1964]. The samples stay where they are on the roll, so the
    bound of a steady waveform is steady. Orders of other rolls add their amplitudes.

    Attributes
    ----------
    slack : factor from the largest sample to the bound.
    at : a column of the own roll.
    quarter : for the compiled law, which needs a quarter of the turn (an order is even or odd
        about its ends): the different orders of the own roll, (m,); which of them each column is,
        -1 for another roll's; cosines and sines, (m, points); space to work in.
    """

    __slots__ = ("_order", "_others", "_pair", "_wave", "_waves", "at", "quarter", "slack")

    def __init__(self, order: Floats, roll_of: Sequence[str], own: str) -> None:
        mine = np.array([roll == own for roll in roll_of])
        self._order = order
        self.at = int(np.argmax(mine))
        self._others = np.flatnonzero(~mine)
        highest = int(order[mine].max(initial=1.0))
        points = POINTS_PER_ORDER * highest
        self.slack = 1.0 / math.cos(math.pi * highest / points)
        angle = np.arange(points) * (math.tau / points)
        turned = np.where(mine, np.exp(1j * np.outer(angle, order)), 0.0)
        # Re (c e^{j a}) = re c cos a - im c sin a, for c as pairs of reals
        self._waves = np.conjugate(turned).view(np.float64)
        self._pair = np.zeros((2, order.size), dtype=np.complex128)
        self._wave = np.zeros(points)
        self.quarter = _quarter(np.where(mine, order, 0.0), points // 4)

    def of(
        self,
        parts: npt.NDArray[np.complex128],
        carrier: npt.NDArray[np.complex128],
        omega_rad_s: Floats,
    ) -> tuple[float, float]:
        """Return bounds of value and slew for terms ``parts`` on carriers e^{j n theta}.

        The slew of the own roll is its speed times the slope over the angle.
        """
        value, slope = self._pair
        np.conjugate(carrier, out=value)
        value *= parts
        np.multiply(value, self._order, out=slope)
        slope *= 1j
        peak = self.slack * self._largest(value)
        slew = self.slack * self._largest(slope)
        slew *= abs(float(omega_rad_s[self.at]))
        if self._others.size:
            rest = np.abs(parts[self._others])
            turning = (self._order * omega_rad_s)[self._others]
            peak += float(rest.sum())
            slew += float(rest @ np.abs(turning))
        return peak, slew

    def _largest(self, parts: npt.NDArray[np.complex128]) -> float:
        wave = self._wave
        np.dot(self._waves, parts.view(np.float64), out=wave)
        np.abs(wave, out=wave)
        return float(np.maximum.reduce(wave))


def _quarter(order: Floats, steps: int) -> tuple[npt.NDArray[Any], ...]:
    """Return what ``PeakBound.quarter`` holds; order 0 stands for another roll's column."""
    orders = np.unique(order[order > 0.0])
    of = np.where(order > 0.0, np.searchsorted(orders, order), -1).astype(np.int64)
    angle = np.arange(steps + 1) * (0.5 * math.pi / steps)
    turned = np.outer(orders, angle)
    sums = np.zeros(4 * orders.size + 8 * angle.size)
    return orders, of, np.cos(turned), np.sin(turned), sums
