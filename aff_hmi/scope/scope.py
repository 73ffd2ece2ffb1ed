"""Behind the page of the scope: takes every tick that arrives, and answers what a page asks."""

from __future__ import annotations

from collections.abc import Callable

from aff_hmi.layout import Layout, label_of
from aff_hmi.scope.shot import Shot, ShotRequest, count_of, shot_of
from aff_hmi.scope.signals import NEEDED, THETA, Signal, signals_of
from aff_hmi.scope.ticks import Cut, Ticks
from aff_hmi.watch import News, Observed

LOOKS_BACK_S = 60.0  # of a trigger, for what has fired already


class Scope:
    """Every tick of the line of the last ten minutes.

    Parameters
    ----------
    wall : returns wall time, s since 1970.
    """

    def __init__(self, wall: Callable[[], float]) -> None:
        self.ticks = Ticks(wall)
        self._news: tuple[str, tuple[str, ...]] = ("", ())

    def listen(self, news: News) -> None:
        """Take what a poll has brought."""
        self._news = (news.ring, news.columns)
        if self.ticks.is_of(news.ring, news.columns):
            self.ticks.add(news.records, news.events)

    def look(self, seen: Observed, layout: Layout) -> None:
        """Begin anew with a ring that is another one, once the site is known."""
        site = seen.site
        ring, columns = self._news
        if site is None or self.ticks.is_of(ring, columns):
            return
        if all(name in columns for name in NEEDED):
            self.ticks.begin(ring, columns, signals_of(columns, site), site.cycle_s)

    @property
    def signals(self) -> tuple[Signal, ...]:
        """What a page may ask for now."""
        return self.ticks.signals

    @property
    def rolls(self) -> tuple[tuple[str, str], ...]:
        """Every roll whose angle is kept, with its label."""
        names = [one.name.removesuffix(THETA) for one in self.signals if one.name.endswith(THETA)]
        return tuple((name, label_of(name)) for name in names)

    def shot(self, asked: ShotRequest, kept: Cut | None = None) -> Shot | None:
        """Return the ticks that are wanted, of what arrives or of a window that is kept.

        None while a trigger has not fired.

        Raises
        ------
        KeyError
            When a signal or a roll is not kept.
        """
        cut = self._wanted(asked) if kept is None else kept
        for name in (*asked.names, *([asked.roll + THETA] if asked.roll else [])):
            cut.of(name)
        return shot_of(cut, asked)

    def _wanted(self, asked: ShotRequest) -> Cut:
        """Return the ticks that a shot can be of: few are copied, whatever is asked."""
        newest, cycle_s = self.ticks.newest(), self.ticks.cycle_s
        count = count_of(asked, cycle_s)
        if asked.trigger is None:
            end = newest if asked.end < 0 else min(asked.end, newest)
            return self.ticks.cut(end - count, count + 1)
        back = max(count, round(LOOKS_BACK_S / cycle_s) if cycle_s > 0.0 else 0)
        return self.ticks.cut(max(asked.after - count, newest - back), back + 1)
