"""When to tick on a wire whose other side only answers: away from the edge of its scan."""

from __future__ import annotations

from typing import Final

WINDOW_TICKS: Final = 200
"""Over which the heartbeat's steps are counted, 1 s at 5 ms, and looked at every"""
LOOK_TICKS: Final = 25
FEWEST: Final = 3
"""Of short and of long steps each in a window (1.5 %): less is a late tick or two."""
MOVE_TICKS: Final = 200
"""At least, in which the grid moves by a period: the half percent that the ticker allows."""
RETURNS_WINDOWS: Final = 5
"""If the edge is back so soon the two clocks differ by 0.03 % and more: moving does not help,"""
PAUSE_WINDOWS: Final = 60
"""and nothing is moved for so long."""
_LONGEST = 16  # steps of so many scans, and of so many ticks, and more count as one


class ScanEdge:
    """Moves the ticks by half a scan where they fall on the edge of the other side's scan.

    There the jitter of a tick decides which scan it reads: now one sees nothing new, now the next
    sees two scans, and the command acts a scan early or late likewise. The heartbeat, one count a
    scan, shows both: steps that are shorter and longer by one than is usual. Of a PLC whose scan
    lasts several ticks it is the ticks from one step to the next that are one fewer or more.
    Clocks that drift pass every edge; half a scan, or half a tick, away is as far as one gets.

    Parameters
    ----------
    period_ns : of the ticks.
    modulus : counts after which the heartbeat starts over.
    """

    def __init__(self, period_ns: int, modulus: int) -> None:
        self._period_ns = period_ns
        self._modulus = modulus
        self._last = 0
        self._begin()
        self._since = 0
        self._left_ns = self._pause_windows = 0
        self._calm_windows = RETURNS_WINDOWS

    def _begin(self) -> None:
        """Begin a window; entry i counts steps of i scans, and steps that came after i ticks."""
        self._steps = [0] * (_LONGEST + 1)
        self._waits = [0] * (_LONGEST + 1)
        self._ticks = 0

    def shift_ns(self, heartbeat: int) -> int:
        """Return how much later the next tick should start, ns, after a reading of its scan."""
        step = (heartbeat - self._last) % self._modulus
        self._last = heartbeat
        if self._left_ns:
            shift_ns = min(self._left_ns, self._period_ns // MOVE_TICKS)
            self._left_ns -= shift_ns
            return shift_ns
        self._steps[min(step, _LONGEST)] += 1
        self._since += 1
        if step:
            self._waits[min(self._since, _LONGEST)] += 1
            self._since = 0
        self._ticks += 1
        if self._ticks % LOOK_TICKS == 0:
            self._look()
        return 0

    def _look(self) -> None:
        """Judge a window; begin the next one when it is full, or was enough."""
        way_ns = self._way_ns()
        if self._ticks < WINDOW_TICKS and (self._pause_windows or not way_ns):
            return
        self._begin()
        self._calm_windows += 1
        if self._pause_windows:
            self._pause_windows -= 1
        elif way_ns:
            if self._calm_windows > RETURNS_WINDOWS:
                self._left_ns = way_ns
            else:
                self._pause_windows = PAUSE_WINDOWS
            self._calm_windows = 0

    def _way_ns(self) -> int:
        """Return how far it is away from the edge, ns; 0 where the ticks are not on one."""
        scans = _usual(self._steps)
        if scans and self._steps[scans] > self._steps[0]:
            return self._period_ns // (2 * scans)
        return self._period_ns // 2 if _usual(self._waits) else 0


def _usual(counts: list[int]) -> int:
    """Return the usual one of numbers, if one fewer and one more are seen beside it; else 0."""
    usual = max(range(1, _LONGEST), key=counts.__getitem__)
    return usual if min(counts[usual - 1], counts[usual + 1]) >= FEWEST else 0
