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
_LONGEST = 16  # steps of so many scans and more count as one


class ScanEdge:
    """Moves the ticks by half a scan where they fall on the edge of the other side's scan.

    There the jitter of a tick decides which scan it reads: now one sees nothing new, now the next
    sees two scans, and the command acts a scan early or late likewise. The heartbeat, one count a
    scan, shows both. Clocks that drift pass every edge; half a scan away is as far as one gets.

    Where a tick sees less than a scan as a rule, or always the same, nothing is moved.

    Parameters
    ----------
    period_ns : of the ticks.
    modulus : counts after which the heartbeat starts over.
    """

    def __init__(self, period_ns: int, modulus: int) -> None:
        self._period_ns = period_ns
        self._modulus = modulus
        self._last = 0
        self._seen = [0] * (_LONGEST + 1)
        self._left_ns = self._ticks = self._pause_windows = 0
        self._calm_windows = RETURNS_WINDOWS

    def shift_ns(self, heartbeat: int) -> int:
        """Return how much later the next tick should start, ns, after a reading of its scan."""
        step = (heartbeat - self._last) % self._modulus
        self._last = heartbeat
        if self._left_ns:
            shift_ns = min(self._left_ns, self._period_ns // MOVE_TICKS)
            self._left_ns -= shift_ns
            return shift_ns
        self._seen[min(step, _LONGEST)] += 1
        self._ticks += 1
        if self._ticks % LOOK_TICKS == 0:
            self._look()
        return 0

    def _look(self) -> None:
        """Judge the steps of a window; begin the next one when it is full, or was enough."""
        seen = self._seen
        usual = max(range(1, _LONGEST), key=seen.__getitem__)
        at_edge = min(seen[usual - 1], seen[usual + 1]) >= FEWEST and seen[usual] > seen[0]
        if self._ticks < WINDOW_TICKS and (self._pause_windows or not at_edge):
            return
        self._seen = [0] * (_LONGEST + 1)
        self._ticks = 0
        self._calm_windows += 1
        if self._pause_windows:
            self._pause_windows -= 1
        elif at_edge:
            if self._calm_windows > RETURNS_WINDOWS:
                self._left_ns = self._period_ns // (2 * usual)
            else:
                self._pause_windows = PAUSE_WINDOWS
            self._calm_windows = 0
