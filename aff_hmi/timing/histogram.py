"""Times of every tick in classes of equal ratio: since the start, and of the last minute."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

LEAST_US, PER_DECADE, DECADES = 10.0, 10, 4
# upper edges, us; what is beyond the last is in one class more
EDGES_US = LEAST_US * 10.0 ** (np.arange(PER_DECADE * DECADES + 1) / PER_DECADE)
MINUTE_S = 60


@dataclass(frozen=True, slots=True, kw_only=True)
class Figures:
    """How many times, their percentiles and the largest, us; None before the first tick."""

    count: int
    p50: float | None
    p99: float | None
    p999: float | None
    largest: float | None


class Histogram:
    """Counts times, us.

    The upper edge of its class stands for a time: a percentile is at most a quarter too large,
    and never too small; largest and sum are exact.

    Attributes
    ----------
    counts : of every class. ``total_us`` : sum of all times, us.
    """

    def __init__(self) -> None:
        self.counts: NDArray[np.int64] = np.zeros(len(EDGES_US) + 1, dtype=np.int64)
        self._largest = math.nan
        self.total_us = 0.0

    def add(self, times_us: NDArray[np.float64]) -> None:
        """Count times; what is not finite is left out."""
        known = times_us[np.isfinite(times_us)]
        if not known.size:
            return
        self.counts += np.bincount(np.searchsorted(EDGES_US, known), minlength=len(self.counts))
        self._largest = float(np.fmax(self._largest, known.max()))
        self.total_us += float(known.sum())

    def join(self, other: Histogram) -> None:
        """Take what another one has counted."""
        self.counts += other.counts
        self._largest = float(np.fmax(self._largest, other._largest))
        self.total_us += other.total_us

    def figures(self) -> Figures:
        """Return what a person reads of it."""
        p50, p99, p999 = (self._quantile(q) for q in (0.5, 0.99, 0.999))
        return Figures(
            count=int(self.counts.sum()),
            p50=p50,
            p99=p99,
            p999=p999,
            largest=self._largest if math.isfinite(self._largest) else None,
        )

    def _quantile(self, share: float) -> float | None:
        total = int(self.counts.sum())
        if not total:
            return None
        at = int(np.searchsorted(np.cumsum(self.counts), math.ceil(share * total)))
        is_last = at >= len(EDGES_US) or EDGES_US[at] > self._largest
        return self._largest if is_last else float(EDGES_US[at])


class Times:
    """One column of the record: all ticks that this screen has seen, and those of a minute."""

    def __init__(self) -> None:
        self.whole = Histogram()
        self._seconds: deque[tuple[int, Histogram]] = deque(maxlen=MINUTE_S)

    def add(self, times_us: NDArray[np.float64], second: int) -> None:
        """Count the times of one second; ``second`` never runs backwards."""
        fresh = Histogram()
        fresh.add(times_us)
        self.whole.join(fresh)
        if not self._seconds or self._seconds[-1][0] != second:
            self._seconds.append((second, fresh))
        else:
            self._seconds[-1][1].join(fresh)

    def minute(self, second: int) -> Histogram:
        """Return the last minute before a second."""
        total = Histogram()
        for at, one in self._seconds:
            if second - at < MINUTE_S:
                total.join(one)
        return total
