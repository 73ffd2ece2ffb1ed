"""What a person does with windows: keeps one with a name and a note, deletes one."""

from __future__ import annotations

import sqlite3
from collections.abc import Mapping
from pathlib import PurePath

from aff_hmi.layout import Layout
from aff_hmi.scope.scope import Scope
from aff_hmi.scope.ticks import Cut
from aff_hmi.see.events import Kind
from aff_hmi.see.journal import Journal
from aff_hmi.see.store import Store
from aff_hmi.watch import Observed
from aff_hmi.windows.rows import (
    SHARE,
    SHARE_OF_ALARMS,
    FullError,
    Window,
    begin,
    delete,
    keep,
    keep_of_alarm,
    listed,
    ticks_of,
)
from aff_hmi.words import N_
from aff_runtime.app.door.messages import Facts
from aff_runtime.base.printable import printable

MOST_S = 60.0
MOST_TICKS = 20_000
LOST_SHARE = 0.1
"""Of the window asked for: how much may lack, such as what is gone while a person types."""
LEAST_NAME, LONGEST_NAME, LONGEST_NOTE = 2, 60, 500
NO_NAME = N_("give it a name of two characters or more")
NO_TICKS = N_("these ticks are not kept any more, or are more than a minute or 20 000 ticks")
FULL = N_("no space is left for another window: delete one first")
NOT_THERE = N_("this window is not there any more")
NOT_KEPT = N_("it could not be kept; try again")
NOT_DELETED = N_("it could not be deleted; try again")
KEPT = N_("the window {window} was kept")
DELETED = N_("the window {window} was deleted")


class WindowDesk:
    """Keeps windows of the scope; a press returns why it is refused, in English, or an empty text.

    Parameters
    ----------
    store, journal : where they are kept and written down.

    Attributes
    ----------
    scope : whose ticks they are.
    """

    def __init__(self, scope: Scope, store: Store, journal: Journal) -> None:
        self.scope = scope
        self._store = store
        self._journal = journal
        self._line = self._config = self._run = ""
        self._facts: Facts | None = None
        store.put(begin)

    def look(self, seen: Observed, layout: Layout) -> None:
        """Take note of which run and which settings a window would be of."""
        self._line = layout.line
        facts = seen.facts
        if facts is not None and facts is not self._facts:
            self._facts = facts
            recorder = facts.status.recorder
            self._config = facts.status.config_hash[:8]
            self._run = PurePath(recorder.folder).name if recorder is not None else ""

    async def keep(self, said: Mapping[str, str | int | bool], who: str) -> str:
        """Keep the ticks from ``first`` to ``last`` of a ring with every signal of the scope."""
        name = printable(str(said["name"]).strip(), LONGEST_NAME)
        note = printable(str(said["note"]).strip(), LONGEST_NOTE)
        if len(name) < LEAST_NAME:
            return NO_NAME
        is_same_ring = said["ring"] == self.scope.ticks.ident
        cut = self._cut(int(said["first"]), int(said["last"])) if is_same_ring else None
        if cut is None:
            return NO_TICKS
        window = self._window(cut, name=name, note=note, who=who)
        most = round(SHARE * self._store.most_bytes)
        try:
            await self._store.change(lambda c: keep(c, window, cut, most))
        except FullError:
            return FULL
        except (sqlite3.Error, BlockingIOError):
            return NOT_KEPT
        self._tell(KEPT, name, who)
        return ""

    def keep_of(self, alarm: str, cut: Cut) -> None:
        """Keep the ticks around an alarm; the oldest of their kind make room."""
        name = printable(alarm, LONGEST_NAME)
        window = self._window(cut, name=name, note="", who="", alarm=name)
        most = round(SHARE_OF_ALARMS * self._store.most_bytes)
        self._store.put(lambda c: keep_of_alarm(c, window, cut, most))

    def _window(self, cut: Cut, *, name: str, note: str, who: str, alarm: str = "") -> Window:
        return Window(
            name=name,
            note=note,
            who=who,
            utc_s=round(cut.utc_s + float(cut.time_s[0]), 3),
            seconds=round(float(cut.time_s[-1] - cut.time_s[0]), 3),
            first=int(cut.ticks[0]),
            last=int(cut.ticks[-1]),
            run=printable(self._run, LONGEST_NAME),
            config=self._config,
            line=self._line,
            alarm=alarm,
        )

    async def delete(self, said: Mapping[str, str | int | bool], who: str) -> str:
        """Delete a window."""
        number = int(said["number"])
        try:
            name = await self._store.change(lambda c: delete(c, number))
        except (sqlite3.Error, BlockingIOError):
            return NOT_DELETED
        if not name:
            return NOT_THERE
        self._tell(DELETED, name, who)
        return ""

    async def windows(self) -> list[Window]:
        """Return what is said of every window.

        Raises
        ------
        BlockingIOError, sqlite3.Error
            When they cannot be read now.
        """
        return await self._store.ask(listed)

    async def ticks(self, number: int) -> Cut | None:
        """Return the ticks of a window, None when there is none; raises as ``windows``."""
        return await self._store.ask(lambda c: ticks_of(c, number))

    def _cut(self, first: int, last: int) -> Cut | None:
        """Return the ticks of a span; None for none, too many, or where too much lacks."""
        cycle_s = self.scope.ticks.cycle_s
        if not 0 <= first <= last or cycle_s <= 0.0:
            return None
        most = min(MOST_TICKS, round(MOST_S / cycle_s) + 1)
        if last - first >= most:
            return None
        asked_ticks = last - first + 1
        allowed_lost_ticks = LOST_SHARE * asked_ticks
        cut = self.scope.ticks.cut(first, asked_ticks)
        inside = cut.part(0, int((cut.ticks <= last).sum()))
        is_whole = len(inside) > 1 and asked_ticks - len(inside) <= allowed_lost_ticks
        return inside if is_whole else None

    def _tell(self, text: str, name: str, who: str) -> None:
        self._journal.add(Kind.PERSON, "WINDOW", text, who=who, window=name)
