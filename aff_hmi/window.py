"""The last ten seconds of a few columns, and what is read off them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

WINDOW_S = 10.0
NOW_S = 0.1
LEAST_SHARE = 0.9  # of a window, before a figure of it is told


class Window:
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
        self._rows: NDArray[np.float64] = np.full((self._size, len(self._at)), np.nan)
        self._count = 0

    def add(self, records: NDArray[np.float64] | Sequence[Sequence[float]]) -> None:
        """Append records of the ring in order."""
        rows = np.asarray(records[-self._size :], dtype=float)[:, self._from]
        places = np.arange(self._count, self._count + len(rows)) % self._size
        self._rows[places] = rows
        self._count += len(rows)

    def mean_now(self, name: str) -> float:
        """Return the mean of the last tenth of a second; NaN when nothing is known."""
        at = self._at.get(name)
        if at is None or self._count == 0:
            return np.nan
        newest = np.arange(max(0, self._count - self._now), self._count) % self._size
        values = self._rows[newest, at]
        values = values[np.isfinite(values)]
        return float(values.mean()) if values.size else np.nan

    def rms(self, name: str) -> float:
        """Return the deviation from the mean of the window, rms; NaN while it is not full."""
        values = self._known(name)
        return float(values.std()) if values.size else np.nan

    def peak(self, name: str) -> float:
        """Return the largest absolute value in the window; NaN while nothing is known."""
        at = self._at.get(name)
        values = self._rows[:, at] if at is not None else np.empty(0)
        values = values[np.isfinite(values)]
        return float(np.abs(values).max()) if values.size else np.nan

    def _known(self, name: str) -> NDArray[np.float64]:
        """Return the finite values of a column, none while the window has holes."""
        at = self._at.get(name)
        values = self._rows[:, at] if at is not None else np.empty(0)
        found = values[np.isfinite(values)]
        return found if found.size >= LEAST_SHARE * self._size else np.empty(0)
