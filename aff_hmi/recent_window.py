"""The last ten seconds of a few columns, and what is read off them."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

WINDOW_S = 10.0
NOW_S = 0.1
LEAST_SHARE = 0.9  # of a window, before a figure of it is told


class RecentWindow:
    """Rows of the ring, the newest ``WINDOW_S`` of them.

    Parameters
    ----------
    columns : of the ring. ``kept`` : those that are wanted here.
    cycle_s : period of the control cycle.
    """

    def __init__(self, columns: Sequence[str], kept: Sequence[str], cycle_s: float) -> None:
        self._at = {name: i for i, name in enumerate(name for name in kept if name in columns)}
        self._from = [columns.index(name) for name in self._at]
        self._size = max(2, round(WINDOW_S / cycle_s))
        self._now = max(1, round(NOW_S / cycle_s))
        # a column lies in one piece: it is read as a whole, ten times a second
        self._columns: NDArray[np.float64] = np.full((len(self._at), self._size), np.nan)
        self._count = 0

    def add(self, records: NDArray[np.float64] | Sequence[Sequence[float]]) -> None:
        """Append records of the ring in order."""
        rows = np.asarray(records[-self._size :], dtype=float)[:, self._from]
        places = np.arange(self._count, self._count + len(rows)) % self._size
        self._columns[:, places] = rows.T
        self._count += len(rows)

    def mean_now(self, name: str) -> float:
        """Return the mean of the last tenth of a second; NaN when nothing is known."""
        column, end = self._column(name), self._count % self._size
        begin = end - min(self._now, self._count)
        parts = [column[begin:end]] if begin >= 0 else [column[begin:], column[:end]]
        values = _finite(np.concatenate(parts))
        return float(values.sum()) / values.size if values.size else math.nan

    def rms(self, name: str) -> float:
        """Return the deviation from the mean of the window, rms; NaN while it is not full."""
        values = _finite(self._column(name))
        if not values.size or values.size < LEAST_SHARE * self._size:
            return math.nan
        deviation = values - float(values.sum()) / values.size
        return math.sqrt(float(deviation @ deviation) / values.size)

    def peak(self, name: str) -> float:
        """Return the largest absolute value in the window; NaN while nothing is known."""
        values = _finite(self._column(name))
        return float(max(values.max(), -values.min())) if values.size else math.nan

    def _column(self, name: str) -> NDArray[np.float64]:
        """Return a column, the newest values anywhere in it; empty where there is none."""
        at = self._at.get(name)
        return self._columns[at] if at is not None else np.empty(0)


def _finite(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the finite ones of some values; mostly all are, and then so is their sum."""
    return values if math.isfinite(values.sum()) else values[np.isfinite(values)]
