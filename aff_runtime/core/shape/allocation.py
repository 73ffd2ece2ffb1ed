"""What of every column goes out when the output meets its limit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from aff_runtime.core.shape.bounds import PeakBound
from aff_runtime.core.shape.columns import ColumnState
from aff_runtime.core.shape.fitting import WaveFit
from aff_runtime.core.shape.wish import Wish

Floats = npt.NDArray[np.float64]
MARGIN = 0.98  # of the headroom, so that the guard need not scale what is on its way
FOLLOW_S = 0.1  # time constant with which the factors follow the fit
FIT_S = 0.005  # from one step of the fit to the next; a shorter cycle has no time for more
DAMPED = 0.1  # of the way to what the price leaves of another roll's column, per step of the fit
WHOLE = 1e-3  # factors this close to 1 are 1, and no limit takes anything
LEAST_SLEW = 0.2  # of the slew limit, what learning leaves at least
TINY = 1e-12  # output units, rad/s or ripple: no less is divided by


class Headroom(NamedTuple):
    """What the guard lets out unscaled: value and slew, output units and per second."""

    limit: float
    slew_limit: float


class OutputAllocation:
    """A complex factor per column; together they leave the least ripple that fits in the headroom.

    The own roll's waveform is fitted by ``WaveFit``. A column of another roll, whose angle goes
    its own way, takes its amplitude off the headroom and pays the same price: it is shortened by
    price / (2 q |c|), never below zero. The weights keep the shape: what the limit took is not
    learned away, nothing winds up; whole orders are scaled and turned, so no harmonics arise.

    Attributes
    ----------
    factor : what of each weight goes out, 1 without a limit; it follows the fit within 0.1 s.
    share : 1 - |1 - factor|, 0..1: how much of the column's ripple is taken off.
    limited : whether a limit takes something.
    peak, slew : bounds of the last output.
    moved_1_s : slew of the output by factors that moved in this tick, output units per second.
    """

    __slots__ = (
        "_first",
        "_fit",
        "_fitted",
        "_gather",
        "_mine",
        "_of",
        "_order",
        "_others",
        "_slack",
        "_waited_s",
        "factor",
        "limited",
        "moved_1_s",
        "peak",
        "share",
        "slew",
    )

    def __init__(
        self,
        state: ColumnState,
        order: Floats,
        roll_of: Sequence[str],
        own: str,
        bounds: PeakBound,
    ) -> None:
        self.factor = state.array("allocation.factor", 1.0, dtype=np.complex128)
        self._fitted = state.array("allocation.fitted", 1.0, dtype=np.complex128)
        self.share = state.array("allocation.share", 1.0)
        mine = np.array([roll == own for roll in roll_of])
        self._mine, self._others = np.flatnonzero(mine), np.flatnonzero(~mine)
        # an imbalance has the order of another column: per different order the first column that
        # has it, per column of the own roll the index of its order
        orders, first, of = np.unique(order[mine], return_index=True, return_inverse=True)
        self._first, self._of = self._mine[first], of
        self._gather = (of == np.arange(orders.size)[:, None]).astype(np.float64)
        self._order = order
        self._fit = WaveFit(orders)
        self._slack = bounds.slack
        self._waited_s = FIT_S
        self.limited = False
        self.peak = self.slew = self.moved_1_s = 0.0

    def binds(self, headroom: Headroom) -> bool:
        """Whether there is work: a limit takes something, or the last output is at one."""
        return (
            self.limited
            or self.peak > MARGIN * headroom.limit
            or self.slew > MARGIN * headroom.slew_limit
        )

    def step(self, headroom: Headroom, wish: Wish, dt_s: float) -> None:
        """Move the factors towards what fits."""
        self.limited = True
        size = np.abs(wish.parts)
        self._waited_s += dt_s
        if self._waited_s > 0.9 * FIT_S:
            self._waited_s = 0.0
            self._find(headroom, wish, size)
        self._follow(size, dt_s)

    def _find(self, headroom: Headroom, wish: Wish, size: Floats) -> None:
        """Take one step of the fit: the own roll's waveform, then the columns of other rolls."""
        own, others, fitted = self._mine, self._others, self._fitted
        omega = max(abs(float(wish.omega_rad_s[own[0]])), TINY) if own.size else TINY
        turning = np.abs(self._order * wish.omega_rad_s)[others]
        taken = np.abs(fitted[others]) * size[others]
        slew_headroom = MARGIN * headroom.slew_limit - wish.learning_1_s
        slew = max(slew_headroom, LEAST_SLEW * headroom.slew_limit) - float(taken @ turning)
        limit = max(MARGIN * headroom.limit - float(taken.sum()), 0.0) / self._slack
        slope = max(slew, 0.0) / (self._slack * omega)
        if own.size:
            self._fit_own(wish, limit, slope)
        if others.size:
            price, of_slope = self._fit.prices()
            per_unit = price + of_slope * turning / omega
            worth = 2.0 * wish.worth[others] * size[others]
            left = np.maximum(1.0 - per_unit / np.maximum(worth, TINY), 0.0)
            fitted[others] += DAMPED * (left - fitted[others])

    def _fit_own(self, wish: Wish, limit: float, slope: float) -> None:
        parts, own, of = wish.parts, self._mine, self._of
        wanted = self._gather @ (parts[own] * wish.carrier[own].conj())
        before = self._fitted[self._first] * wanted
        found = self._fit.step(before, wanted, wish.worth[self._first], limit, slope)
        there = np.abs(wanted) > TINY
        self._fitted[own] = np.where(there, found / np.where(there, wanted, 1.0), 1.0)[of]

    def _follow(self, size: Floats, dt_s: float) -> None:
        move = (self._fitted - self.factor) * -math.expm1(-dt_s / FOLLOW_S)
        self.factor += move
        missing = np.abs(1.0 - self.factor)
        if not self._fit.price.any() and float(missing.max()) < WHOLE:
            self.factor[:] = self._fitted[:] = 1.0
            self.limited = False
        np.subtract(1.0, np.minimum(missing, 1.0), out=self.share)
        if not self.limited:
            self.share[:] = 1.0
        self.moved_1_s = float(np.abs(move) @ size) / dt_s

    def adopt(self, old: OutputAllocation) -> None:
        """Go on where ``old`` stands, once the arrays per column are taken over."""
        self.peak, self.slew, self.limited = old.peak, old.slew, old.limited
        self._fit.adopt(old._fit)

    def restart(self) -> None:
        """Start from nothing."""
        self.factor[:] = self._fitted[:] = self.share[:] = 1.0
        self._fit.price[:] = 0.0
        self.peak = self.slew = self.moved_1_s = 0.0
        self.limited = False
