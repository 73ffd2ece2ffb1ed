"""When the next tick is due: absolute deadlines; missed ticks are skipped and counted."""

from __future__ import annotations

from typing import Final

from aff_runtime.base.ports import Clock

_MOST_SHIFT: Final = 200  # a period is made longer or shorter by at most 1/200 of itself


class Ticker:
    """Keeps a grid of deadlines ``period_ns`` apart.

    A tick that comes late by less than half a period runs at once; a later one waits for the next
    point of the grid. So two ticks never start closer than half a period, and there is no burst
    after a stall.

    Attributes
    ----------
    deadline_ns : grid point of the present tick, ns.
    wake_ns : lateness of the present tick against the grid point it waited for, ns.
    late : the work of the last tick ran past the present tick's grid point, or the sleep
        before it did not end for half a period and more.
    missed : grid points skipped since the start.
    """

    def __init__(self, clock: Clock, period_ns: int) -> None:
        self._clock = clock
        self.period_ns = period_ns
        self.deadline_ns = clock.now_ns()
        self.wake_ns = 0
        self.late = False
        self.missed = 0

    def start(self) -> None:
        """Begin the grid now; whatever passed before does not count."""
        self.deadline_ns = self._clock.now_ns()

    def shift(self, wanted_ns: int) -> None:
        """Move the grid towards the wire's own pace, by at most half a percent of a period.

        The number of periods still counts time: a tick that is off by so little is one period.
        """
        most_ns = self.period_ns // _MOST_SHIFT
        self.deadline_ns += max(-most_ns, min(most_ns, wanted_ns))

    def wait(self) -> int:
        """Sleep to the next tick; return whole periods since the last one (1 when none missed)."""
        due_ns = self.deadline_ns + self.period_ns
        now_ns = self._clock.now_ns()
        self.late = now_ns > due_ns
        skipped = max(0, (now_ns - due_ns + self.period_ns // 2) // self.period_ns)
        self.missed += skipped
        self.deadline_ns = due_ns + skipped * self.period_ns
        self._clock.sleep_until_ns(self.deadline_ns)
        self.wake_ns = self._clock.now_ns() - self.deadline_ns
        # held up in the sleep itself: what passed counts in this tick, not in the next one
        overslept = max(0, (self.wake_ns + self.period_ns // 2) // self.period_ns)
        self.late = self.late or overslept > 0
        self.missed += overslept
        self.deadline_ns += overslept * self.period_ns
        return 1 + skipped + overslept
