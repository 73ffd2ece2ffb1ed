"""Filtered-x: what every column does to the signal, through the loop's impulse response."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from aff_runtime.core.impulse import LoopModel
from aff_runtime.core.shape.columns import ColumnMap

Complexes = npt.NDArray[np.complex128]
RADIUS_STEP = 0.002
MAX_MISSED = 40


class LoopFilter:
    """Convolution of N complex columns with P, twice: unweighted and as they went out.

    A ring of twice the length keeps the last samples contiguous, so one product per tick does
    all columns at once. Double precision: a rounding of 6e-8 here would flip an encoder's count
    a few turns later, and the run would depend on how a processor sums.
    """

    __slots__ = ("_at", "_count", "_length", "_loop", "_out", "_radius_m", "_ring", "_taps")

    def __init__(self, loop: LoopModel, columns: int) -> None:
        self._loop = loop
        self._length = loop.taps.shape[1]
        self._count = columns
        self._ring = np.zeros((2 * self._length, 4 * columns))
        self._out = np.zeros(4 * columns)
        self._at = 0
        self._radius_m = float("nan")
        self._taps = np.zeros(self._length)
        self.follow_radius(float("nan"))

    def follow_radius(self, radius_m: float) -> None:
        """Use the taps of this radius from now on; small changes are skipped."""
        if abs(radius_m - self._radius_m) <= RADIUS_STEP * radius_m:
            return
        self._radius_m = radius_m
        # the newest row is the last of the window
        self._taps[:] = self._loop.at(radius_m)[::-1]

    def push(self, plain: Complexes, sent: Complexes, ticks: int) -> None:
        """Append one tick's columns; missed ticks repeat them."""
        n = self._count
        for _ in range(min(max(ticks, 1), MAX_MISSED)):
            for row in (self._ring[self._at], self._ring[self._at + self._length]):
                row[: 2 * n].view(np.complex128)[:] = plain
                row[2 * n :].view(np.complex128)[:] = sent
            self._at = (self._at + 1) % self._length

    def read(self) -> tuple[Complexes, Complexes]:
        """Return P[plain] and P[sent] now, (columns,) each; views, valid until the next call."""
        np.dot(self._taps, self._ring[self._at : self._at + self._length], out=self._out)
        n = 2 * self._count
        return self._out[:n].view(np.complex128), self._out[n:].view(np.complex128)

    def forget(self, columns: npt.NDArray[np.bool_]) -> None:
        """Take the past of some columns out, as after a splice."""
        mask = np.tile(np.repeat(columns, 2), 2)
        self._ring[:, mask] = 0.0

    def adopt(self, old: LoopFilter, both: ColumnMap) -> None:
        """Go on with the past of ``old``; a longer memory starts with what there is."""
        known = min(self._length, old._length)
        past = old._ring[old._at : old._at + old._length][-known:].view(np.complex128)
        now = self._ring.view(np.complex128)
        for end in (self._length, 2 * self._length):
            for mine, theirs in ((0, 0), (self._count, old._count)):
                now[end - known : end, mine + both.mine] = past[:, theirs + both.theirs]
        self._at = 0
