"""Filtered-x: what every column does to the signal, through the loop's impulse response."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from aff_runtime.core.compiled.binary import chosen, holding
from aff_runtime.core.impulse import LoopModel
from aff_runtime.core.shape.columns import ColumnMap

Complexes = npt.NDArray[np.complex128]
RADIUS_STEP = 0.002  # of the radius: a smaller change keeps the taps
MAX_MISSED = 40  # ticks, at most, that one push stands for
BLOCK = 16  # ticks


class LoopFilter:
    """Convolution of N complex columns with P, twice: unweighted and as they went out.

    All of the past in every tick would be 800 rows from memory, most of the time of a paced tick.
    So the past is cut into blocks of 16 ticks. What lies before the present and the last block
    (the tail) is known a block ahead; each tick adds an equal share of its rows to the tails of
    the next 16 outputs, and reads its own tail and the newest rows. The sum is the same, of one
    ninth of the memory per tick.

    A ring of twice the length keeps any window of rows contiguous.
    """

    __slots__ = (
        "_compiled",
        "_count",
        "_held",
        "_length",
        "_loop",
        "_out",
        "_place",
        "_radius_m",
        "_reversed",
        "_ring",
        "_seen",
        "_sent",
        "_share",
        "_tails",
        "_taps",
        "_toeplitz",
    )

    def __init__(self, loop: LoopModel, columns: int) -> None:
        self._loop = loop
        blocks = max(2, -(-loop.taps.shape[1] // BLOCK))
        self._length = blocks * BLOCK
        self._share = blocks - 1  # rows that each tick adds to the next tails
        self._count = columns
        self._ring = np.zeros((2 * self._length, 4 * columns))
        self._tails = np.zeros((2, BLOCK, 4 * columns))
        self._out = np.zeros(4 * columns)
        self._sent = np.zeros(columns, dtype=np.complex128)
        # row of the next sample, which tail is read
        self._place = np.zeros(2, dtype=np.int64)
        self._radius_m = float("nan")
        self._taps = loop.taps[0]
        self._reversed = np.zeros(BLOCK + self._length)
        self._toeplitz = np.zeros((BLOCK, self._length - BLOCK))
        whole = self._out.view(np.complex128)
        self._seen = whole[:columns], whole[columns:]
        self._compiled = chosen()
        self._held = holding(self._ring, self._tails, self._reversed, self._place, self._out)
        self._use(loop.at(float("nan")))

    def follow_radius(self, radius_m: float) -> None:
        """Use the taps of this radius from now on; small changes are skipped."""
        if abs(radius_m - self._radius_m) <= RADIUS_STEP * radius_m:
            return
        self._radius_m = radius_m
        taps = self._loop.at(radius_m)
        if taps is not self._taps and not np.array_equal(taps, self._taps):
            self._use(taps)
            self._renew()

    def _use(self, taps: npt.NDArray[np.float64]) -> None:
        self._taps = taps
        self._reversed[:] = 0.0
        self._reversed[self._length + BLOCK - taps.size :] = taps[::-1]
        for q, row in enumerate(self._toeplitz):
            row[:] = self._reversed[BLOCK - q : self._length - q]

    def _renew(self) -> None:
        """Work the tails out anew, from the whole past."""
        start, done = self._begun()
        read = int(self._place[1])
        ring, length = self._ring, self._length
        np.dot(self._toeplitz, ring[start : start + length - BLOCK], out=self._tails[read])
        known = done * self._share
        past = ring[start + BLOCK : start + BLOCK + known]
        np.dot(self._toeplitz[:, :known], past, out=self._tails[1 - read])

    def _begun(self) -> tuple[int, int]:
        """Return the row where the present block began and how many rows of it are there."""
        at = int(self._place[0])
        done = at % BLOCK
        return at - done, done

    def push(self, plain: Complexes, weight: Complexes, ratio: float, ticks: int) -> None:
        """Append one tick's columns and what went out of them, ``ratio`` times weight times them.

        Missed ticks repeat them.
        """
        times = min(max(ticks, 1), MAX_MISSED)
        if self._compiled is not None:
            self._compiled.loop_push(self._held, plain, weight, ratio, times)
            return
        sent = self._sent
        np.multiply(weight, plain, out=sent)
        sent *= ratio
        for _ in range(times):
            self._append(plain, sent)

    def _append(self, plain: Complexes, sent: Complexes) -> None:
        start, done = self._begun()
        n, at, length = self._count, start + done, self._length
        first, second = self._ring[at], self._ring[at + length]
        as_complex = first.view(np.complex128)
        as_complex[:n] = plain
        as_complex[n:] = sent
        second[:] = first
        rows = slice(done * self._share, (done + 1) * self._share)
        past = self._ring[start + BLOCK : start + length]
        read = int(self._place[1])
        self._tails[1 - read] += self._toeplitz[:, rows] @ past[rows]
        self._place[0] = (at + 1) % length
        if done + 1 == BLOCK:
            self._tails[read] = 0.0
            self._place[1] = 1 - read

    def read(self) -> tuple[Complexes, Complexes]:
        """Return P[plain] and P[sent] now, (columns,) each; views, valid until the next call."""
        if self._compiled is not None:
            self._compiled.loop_read(self._held)
            return self._seen
        start, done = self._begun()
        length = self._length
        newest = self._ring[start + length - BLOCK : start + length + done]
        np.dot(self._reversed[length - done :], newest, out=self._out)
        self._out += self._tails[self._place[1], done]
        return self._seen

    def forget(self, columns: npt.NDArray[np.bool_]) -> None:
        """Take the past of some columns out, as after a splice."""
        mask = np.tile(np.repeat(columns, 2), 2)
        self._ring[:, mask] = 0.0
        self._tails[:, :, mask] = 0.0

    def adopt(self, old: LoopFilter, both: ColumnMap) -> None:
        """Go on with the past of ``old``; a longer memory starts with what there is."""
        known = min(self._length, old._length)
        at = int(old._place[0])
        past = old._ring[at : at + old._length][-known:].view(np.complex128)
        now = self._ring.view(np.complex128)
        for end in (self._length, 2 * self._length):
            for mine, theirs in ((0, 0), (self._count, old._count)):
                now[end - known : end, mine + both.mine] = past[:, theirs + both.theirs]
        self._place[:] = 0
        self._renew()
