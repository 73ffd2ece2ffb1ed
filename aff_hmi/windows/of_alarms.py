"""Keeps the ticks around every alarm of the service: whoever comes later can look at them."""

from __future__ import annotations

from collections import deque

from aff_hmi.layout import Layout
from aff_hmi.see.alarm import Alarm
from aff_hmi.see.alarm_book import AlarmBook
from aff_hmi.see.alarm_part import AROUND_S
from aff_hmi.watch import Observed
from aff_hmi.windows.desk import WindowDesk
from aff_runtime.base.ports import Clock

REMEMBERED = 256
SAME_S = 1.0  # by how much the two clocks of an alarm and its tick may differ
PATIENCE_NS = round(2e9 * AROUND_S)  # where the control process has ended no tick comes after it


class AlarmWindows:
    """Has the desk keep ``AROUND_S`` before and after the tick of each alarm, once.

    Parameters
    ----------
    book : whose alarms they are.
    """

    def __init__(self, book: AlarmBook, desk: WindowDesk, clock: Clock) -> None:
        self._book = book
        self._desk = desk
        self._clock = clock
        self._done: deque[tuple[str, int]] = deque(maxlen=REMEMBERED)

    def look(self, seen: Observed, layout: Layout) -> None:
        """Keep what is whole by now."""
        for alarm in self._book.shown():
            self._keep(alarm)

    def _keep(self, alarm: Alarm) -> None:
        ticks = self._desk.scope.ticks
        if (
            alarm.tick is None
            or not ticks.cycle_s > 0.0
            or (ticks.ident, alarm.tick) in self._done
        ):
            return
        around = round(AROUND_S / ticks.cycle_s)
        is_late = self._clock.now_ns() - alarm.came_ns > PATIENCE_NS
        if ticks.newest() < alarm.tick + around and not is_late:
            return
        self._done.append((ticks.ident, alarm.tick))
        cut = ticks.cut(alarm.tick - around, 2 * around + 1)
        cut = cut.part(0, int((cut.ticks <= alarm.tick + around).sum()))
        at = int((cut.ticks < alarm.tick).sum())
        if at == len(cut) or len(cut) < 2:
            return
        at_s = cut.utc_s + float(cut.time_s[at])
        if cut.ticks[at] == alarm.tick and abs(at_s - alarm.since_s) < SAME_S:
            self._desk.keep_of(alarm.condition.name, cut)
