"""What stands at the tones in one turn of a wave: noise where nothing is sent, else the answer.

Ripple of the site's rolls is taken out by least squares on their angles, in parts so short that
no tick of the control cycle is long; what is left is looked at with a Hann window, which keeps
the ripple of an idler that nobody declared away from the tones.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Iterator, Sequence

import numpy as np
import numpy.fft  # else loaded in the middle of a tick, where it is used first
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]
PART = 100
"""Samples that one tick takes up: 0.1 ms with 100 columns, in the one thread of that process."""
BESIDE = 8
"""Places to both sides of a tone that its noise is told from."""
HANN_NOISE = 1.5
"""Power of white noise in a place of a Hann window, over that of a plain one."""
STIFFENED = 1e-9
"""Of the largest power of a column: rolls that turn alike leave columns that are the same."""
MISSED_SHARE = 0.2


class QuietWindow:
    """A stretch of signals and angles, as long as a wave takes to repeat.

    Parameters
    ----------
    samples, cycle_s : of the stretch.
    signals, angles : how many there are.
    orders : of each angle whose ripple is taken out.
    """

    def __init__(
        self, samples: int, cycle_s: float, *, signals: int, angles: int, orders: int
    ) -> None:
        self._samples, self._cycle_s, self._orders = samples, cycle_s, orders
        self._signals = [array("d") for _ in range(signals)]
        self._angles = [array("d") for _ in range(angles)]
        self._spectra: list[Complexes] = []

    def begin(self) -> None:
        """Forget what was taken."""
        for column in (*self._signals, *self._angles):
            del column[:]
        self._spectra = []

    def take(self, signals: Sequence[float], angles: Sequence[float]) -> None:
        """Take one sample; NaN for a reading that is missing."""
        for column, value in zip(
            (*self._signals, *self._angles), (*signals, *angles), strict=True
        ):
            column.append(value)

    def pass_on(self, ticks: int, signals: Sequence[float], angles: Sequence[float]) -> None:
        """Take one sample, and before it the ticks that were missed as ones without a reading."""
        for _ in range(ticks - 1):
            self.take([math.nan] * len(signals), angles)
        self.take(signals, angles)

    @property
    def is_full(self) -> bool:
        """Whether the stretch is long enough."""
        return len(self._signals[0]) >= self._samples

    @property
    def seconds(self) -> float:
        """How long the stretch is."""
        return self._samples * self._cycle_s

    @property
    def turn_Hz(self) -> float:
        """Frequency of what goes round once in the stretch."""
        return 1.0 / self.seconds

    def weigh(self) -> Iterator[bool]:
        """Work out the spectra, a part each step; True once, at the end.

        Equation: (X'X) b = X'y by parts of the rows, X the cosines and sines of every order.
        """
        signals = np.column_stack([np.asarray(one)[: self._samples] for one in self._signals])
        angles = np.column_stack([np.asarray(one)[: self._samples] for one in self._angles])
        good = np.isfinite(signals).all(axis=1) & np.isfinite(angles).all(axis=1)
        signals, angles = np.where(good[:, None], signals, 0.0), np.where(good[:, None], angles, 0)
        parts = [slice(at, at + PART) for at in range(0, self._samples, PART)]
        columns: list[Floats] = []
        gram: Floats = np.zeros(0)
        share: Floats = np.zeros(0)
        for part in parts:
            rows = self._columns(angles[part], part) * good[part, None]
            columns.append(rows)
            gram = gram + rows.T @ rows if gram.size else rows.T @ rows
            share = share + rows.T @ signals[part] if share.size else rows.T @ signals[part]
            yield False
        gram[np.diag_indices_from(gram)] += STIFFENED * gram.diagonal().max()
        factors = np.linalg.solve(gram, share)
        yield False
        left = np.empty_like(signals)
        for part, rows in zip(parts, columns, strict=True):
            left[part] = signals[part] * good[part, None] - rows @ factors
            yield False
        # good samples next to missing ones stand for them: a few in a thousand
        weights = np.hanning(self._samples + 1)[:-1] * good
        missed = 1.0 - good.mean()
        for column in left.T:
            found = 2.0 * np.fft.rfft(weights * column) / max(float(weights.sum()), 1e-9)
            self._spectra.append(
                found if missed <= MISSED_SHARE else np.full_like(found, math.nan)
            )
            yield False
        yield True

    def _columns(self, angles: Floats, part: slice) -> Floats:
        """Return the rows of the ripple's columns, and of a parabola."""
        at = np.arange(part.start, part.start + len(angles)) / self._samples - 0.5
        turns = (angles[:, :, None] * np.arange(1, self._orders + 1)).reshape(len(angles), -1)
        return np.column_stack([np.ones_like(at), at, at**2, np.cos(turns), np.sin(turns)])

    def is_told(self, signal: int) -> bool:
        """Whether enough of its readings were there."""
        return bool(np.isfinite(self._spectra[signal]).all())

    def phasors(self, signal: int, at: npt.NDArray[np.int64]) -> Complexes:
        """Return what one signal has at places (turns in the stretch), amplitude and phase."""
        return self._spectra[signal][at]

    def noise(self, signal: int, at: npt.NDArray[np.int64]) -> Floats:
        """Return E|n|^2 of the noise at places, from the median of what stands around each.

        Of noise that is normal the median of the power is ln 2 of its mean.
        """
        power = np.abs(self._spectra[signal]) ** 2 / (HANN_NOISE * math.log(2.0))
        last = power.size - 1
        return np.array([_median(power, k, last) for k in np.minimum(at, last)])


def _median(power: Floats, k: int, last: int) -> float:
    """Return the median around one place; numpy's own loads a module at its first use, 40 ms."""
    around = np.sort(power[max(1, k - BESIDE) : min(last, k + BESIDE) + 1])
    return float(around[around.size // 2])
