"""Which orders give way when the output meets its limit."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from aff_runtime.core.shape.columns import ColumnState

Floats = npt.NDArray[np.float64]
RATIO_EPS = 1e-9
SHARE_EPS = 1e-9
MARGIN = 0.97
TAKEN_MORE = 0.01  # of the output, so that the next tick is not at the limit again
RETURN_S = 2.0
LIMIT_GROWS_PER_S = 0.02
LEAST_LIMIT = 0.1  # of the whole wish, from which a limit that took everything grows again
TINY = 1e-9


class OutputAllocation:
    """A share (0..1) per column; the limit takes first what buys least.

    A limit in force comes back as a ratio of the last output's bound. Columns that cost most
    output per unit of signal are shortened until the rest fits; they come back slowly, the most
    useful first, when there is room; a limit that once took everything grows from a tenth of the
    whole wish, so that nothing stays shut for good. The weights keep the shape: what the limit
    took is not learned away, nothing winds up; whole columns are scaled, so no harmonics arise.
    """

    __slots__ = ("_limit", "limited", "peak", "share")

    def __init__(self, state: ColumnState) -> None:
        self.share = state.array("allocation.share", 1.0)
        self.peak = 0.0
        self.limited = False  # whether any column is shortened
        self._limit = math.inf

    def step(
        self,
        limit_ratio: float,
        b: npt.NDArray[np.complex128],
        weight: npt.NDArray[np.complex128],
        signal_per_m: Floats,
        dt_s: float,
    ) -> None:
        """Adjust the shares to the guard's answer on the last output of bound ``peak``.

        ``signal_per_m`` is |P b|: what a metre of each column does to the signal.
        """
        if 0.0 <= limit_ratio < 1.0 - RATIO_EPS:
            self._limit = limit_ratio * self.peak
            excess = (1.0 - limit_ratio + TAKEN_MORE) * self.peak
            self._shorten(excess, b, weight, signal_per_m)
        elif self.limited:
            whole = float(np.abs(weight * b).sum())
            self._limit += LIMIT_GROWS_PER_S * dt_s * max(self._limit, LEAST_LIMIT * whole)
            if self.peak < MARGIN * self._limit:
                cost = np.where(self.share < 1.0, _cost(b, signal_per_m), math.inf)
                at = int(np.argmin(cost))
                risen = self.share[at] + dt_s / RETURN_S
                # whole, but for the rounding of the steps: no rounding decides on one step more
                self.share[at] = 1.0 if risen > 1.0 - SHARE_EPS else risen
                self.limited = bool((self.share < 1.0).any())

    def adopt(self, old: OutputAllocation) -> None:
        """Go on where ``old`` stands, once the shares are taken over."""
        self.peak, self._limit = old.peak, old._limit
        self.limited = bool((self.share < 1.0).any())

    def _shorten(
        self,
        excess: float,
        b: npt.NDArray[np.complex128],
        weight: npt.NDArray[np.complex128],
        signal_per_m: Floats,
    ) -> None:
        amplitude = np.abs(weight * b)
        cost = np.where(self.share * amplitude > TINY, _cost(b, signal_per_m), -1.0)
        for at in np.argsort(-cost):
            if excess <= TINY or cost[at] < 0.0:
                return
            taken = min(float(self.share[at]), excess / float(amplitude[at]))
            self.share[at] -= taken
            excess -= taken * float(amplitude[at])
            self.limited = self.limited or taken > 0.0


def _cost(b: npt.NDArray[np.complex128], signal_per_m: Floats) -> Floats:
    """Return output spent per unit of signal."""
    return np.asarray(np.abs(b) / np.maximum(signal_per_m, TINY))
