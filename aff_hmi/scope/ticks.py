"""Every tick of the last ten minutes, in memory: what a scope looks at."""

from __future__ import annotations

import hashlib
from bisect import bisect_left
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aff_hmi.scope.signals import NEEDED, Signal
from aff_hmi.watch import Rows

KEPT_S = 600.0
MOST_TICKS = 120_000
MOST_EVENTS = 200


@dataclass(frozen=True, slots=True, kw_only=True)
class Cut:
    """Ticks in their order.

    Attributes
    ----------
    ticks : numbers of the ticks, (n,) int64. ``time_s`` : of the control process, (n,).
    states : of the guard, (n,). ``values`` : in the unit of each signal, (n, signals) float32.
    utc_s : wall time at ``time_s`` 0.
    """

    ticks: NDArray[np.int64]
    time_s: NDArray[np.float64]
    states: NDArray[np.int8]
    values: NDArray[np.float32]
    signals: tuple[Signal, ...]
    cycle_s: float
    utc_s: float
    events: tuple[tuple[int, int], ...] = ()

    def __len__(self) -> int:
        return len(self.ticks)

    def of(self, name: str) -> NDArray[np.float32]:
        """Return one signal, (n,).

        Raises
        ------
        KeyError
            When it is not kept.
        """
        at = [one.name for one in self.signals]
        if name not in at:
            raise KeyError(name)
        return self.values[:, at.index(name)]

    def part(self, begin: int, end: int) -> Cut:
        """Return the ticks between two places, with their events."""
        ticks = self.ticks[begin:end]
        inside = [e for e in self.events if len(ticks) and ticks[0] <= e[0] <= ticks[-1]]
        return Cut(
            ticks=ticks,
            time_s=self.time_s[begin:end],
            states=self.states[begin:end],
            values=self.values[begin:end],
            signals=self.signals,
            cycle_s=self.cycle_s,
            utc_s=self.utc_s,
            events=tuple(inside),
        )


class Ticks:
    """Keeps what arrives, ``KEPT_S`` of it and ``MOST_TICKS`` at most.

    Parameters
    ----------
    wall : returns wall time, s since 1970.
    """

    def __init__(self, wall: Callable[[], float]) -> None:
        self._wall = wall
        self._ring = ""
        self._columns: tuple[str, ...] = ()
        self._signals: tuple[Signal, ...] = ()
        self._at: list[int] = []
        self._factors = np.zeros(0)
        self._cycle_s = 0.0
        self._utc_s = 0.0
        self._count = 0
        self._head: NDArray[np.float64] = np.zeros((0, len(NEEDED)))
        self._values: NDArray[np.float32] = np.zeros((0, 0), dtype=np.float32)
        self._events: deque[tuple[int, int]] = deque(maxlen=MOST_EVENTS)

    @property
    def signals(self) -> tuple[Signal, ...]:
        """What is kept now."""
        return self._signals

    @property
    def ident(self) -> str:
        """Which ring is followed, as a digest: tick numbers are of one."""
        return hashlib.sha256(self._ring.encode()).hexdigest()[:12] if self._ring else ""

    def begin(
        self, ring: str, columns: tuple[str, ...], signals: tuple[Signal, ...], cycle_s: float
    ) -> None:
        """Follow a ring; what is kept of another one goes, its ticks have other numbers."""
        size = max(2, min(MOST_TICKS, round(KEPT_S / cycle_s))) if cycle_s > 0.0 else 2
        self._ring, self._columns, self._signals, self._cycle_s = ring, columns, signals, cycle_s
        self._at = [columns.index(name) for name in (*NEEDED, *(one.name for one in signals))]
        self._factors = np.array([one.factor for one in signals])
        self._count = 0
        self._head = np.zeros((size, len(NEEDED)))
        self._values = np.full((size, len(signals)), np.nan, dtype=np.float32)
        self._events.clear()

    def is_of(self, ring: str, columns: tuple[str, ...]) -> bool:
        """Return whether these ticks belong to what is kept."""
        return bool(columns) and (ring, columns) == (self._ring, self._columns)

    def add(self, records: Rows, events: Sequence[tuple[float, ...]] = ()) -> None:
        """Append ticks of the ring that is followed; events are (tick, ns, code, argument)."""
        self._events.extend((int(tick), int(code)) for tick, _, code, _ in events)
        if not len(records):
            return
        size = len(self._head)
        rows = np.asarray(records[-size:])[:, self._at]
        places = np.arange(self._count, self._count + len(rows)) % size
        self._head[places] = rows[:, : len(NEEDED)]
        self._values[places] = rows[:, len(NEEDED) :] * self._factors
        self._count += len(rows)
        self._utc_s = self._wall() - float(rows[-1, 0])

    @property
    def cycle_s(self) -> float:
        """Period of the control cycle; 0 before a ring is followed."""
        return self._cycle_s

    def newest(self) -> int:
        """Return the number of the newest tick; -1 when there is none."""
        if not self._count:
            return -1
        return int(self._head[(self._count - 1) % len(self._head), 1])

    def cut(self, since: int = -1, most: int = MOST_TICKS) -> Cut:
        """Return ``most`` ticks from one on, all that are kept by default; a copy."""
        size, oldest = max(1, len(self._head)), max(0, self._count - len(self._head))
        numbers = range(oldest, self._count)
        begin = oldest + bisect_left(numbers, since, key=lambda i: self._head[i % size, 1])
        order = np.arange(begin, min(self._count, begin + most)) % size
        head = self._head[order]
        return Cut(
            ticks=head[:, 1].astype(np.int64),
            time_s=head[:, 0],
            states=head[:, 2].astype(np.int8),
            values=self._values[order],
            signals=self._signals,
            cycle_s=self._cycle_s,
            utc_s=self._utc_s,
            events=tuple(self._events),
        )
