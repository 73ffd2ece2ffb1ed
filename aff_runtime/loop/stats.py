"""Timing of the cycle as histograms of fixed size: nothing grows from tick to tick."""

from __future__ import annotations

_SUB_BITS = 4
_SUB = 1 << _SUB_BITS
_OCTAVES = 36


class Histogram:
    """Counts durations in bins 1/16 octave wide, from 1 ns to beyond 10 minutes.

    Attributes
    ----------
    count : number of durations.
    max_ns : the longest one, exact.
    """

    def __init__(self) -> None:
        self._bins = [0] * (_SUB * (_OCTAVES + 1))
        self.count = 0
        self.max_ns = 0

    def add(self, duration_ns: int) -> None:
        """Count one duration; negative ones count as zero."""
        duration_ns = max(duration_ns, 0)
        shift = max(0, duration_ns.bit_length() - _SUB_BITS - 1)
        index = shift * _SUB + (duration_ns >> shift)
        self._bins[min(index, len(self._bins) - 1)] += 1
        self.count += 1
        self.max_ns = max(self.max_ns, duration_ns)

    def quantile_ns(self, share: float) -> int:
        """Return a duration that at least ``share`` (0..1) of all do not exceed; 6 % coarse."""
        wanted = share * self.count
        seen = 0
        for index, n in enumerate(self._bins):
            seen += n
            if n and seen >= wanted:
                return min(_upper_edge_ns(index), self.max_ns)
        return self.max_ns


class CycleStats:
    """Wake latency, time on the wire and whole tick, from the start of the service."""

    def __init__(self) -> None:
        self.wake = Histogram()
        self.io = Histogram()
        self.tick = Histogram()

    def add(self, *, wake_ns: int, io_ns: int, tick_ns: int) -> None:
        """Count one tick."""
        self.wake.add(wake_ns)
        self.io.add(io_ns)
        self.tick.add(tick_ns)


def _upper_edge_ns(index: int) -> int:
    shift = max(0, index // _SUB - 1)
    return ((index - shift * _SUB + 1) << shift) - 1
