"""Everything that the screen keeps of a line, and what a page shows of it in a frame."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any, TypeAlias

from aff_hmi.condition import RANK, Condition
from aff_hmi.layout import Layout, label_of
from aff_hmi.notices import conditions_of
from aff_hmi.see import events
from aff_hmi.see.alarm_book import AlarmBook
from aff_hmi.see.alarm_part import KINDS, AlarmPart, alarm_part
from aff_hmi.see.events import Kind
from aff_hmi.see.journal import Journal
from aff_hmi.see.recent_part import RecentPart, recent_part
from aff_hmi.see.rolls_part import rolls_part
from aff_hmi.see.shape_history import ShapeHistory
from aff_hmi.see.store import Store
from aff_hmi.see.trend_part import GROUPS, WINDOW_WORDS, group_name
from aff_hmi.see.trend_rows import SCHEMA as TREND_SCHEMA
from aff_hmi.see.trends import Trends
from aff_hmi.view import GONE, state_of, why_gone
from aff_hmi.watch import News, Observed
from aff_hmi.words import N_, Say, say_in
from aff_runtime.app.hand.bucket import Bucket
from aff_runtime.app.hand.messages import LOGIN_REFUSED
from aff_runtime.app.report.alarm_table import Priority
from aff_runtime.base.clock import wall_time_s
from aff_runtime.base.ports import Clock
from aff_runtime.base.signals import State

LOOK_NS = 450_000_000
FRESH_S = 0.7
ALARMS, ROLLS = "alarms", "rolls"
PEOPLE = {
    "login": N_("logged in"),
    LOGIN_REFUSED: N_("a login was refused"),
    "logout": N_("logged out"),
    "session ended": N_("the session has ended"),
    "session ended by": N_("ended a session"),
    "hand taken": N_("took the hand"),
    "hand taken over": N_("took the hand over"),
    "hand released": N_("released the hand"),
    "hand ended": N_("the hand has ended"),
    "alarm seen": N_("has seen an alarm"),
    "alarm put aside": N_("put an alarm aside"),
    "alarm taken back": N_("took an alarm back"),
    "window kept": N_("kept a window of ticks"),
    "window let go": N_("deleted a window of ticks"),
    "bypass: done": N_("bypass"),
    "bypass: refused": N_("a bypass was refused"),
    "arm: done": N_("armed"),
    "arm: refused": N_("arming was refused"),
    "probe: done": N_("began a probe"),
    "probe: refused": N_("a probe was refused"),
    "shadow: done": N_("began shadow operation"),
    "shadow: refused": N_("shadow operation was refused"),
    "end-shadow: done": N_("ended shadow operation"),
    "end-shadow: refused": N_("the end of shadow operation was refused"),
    "forget: done": N_("had what was learned of a roll forgotten"),
    "forget: refused": N_("forgetting was refused"),
}

Part: TypeAlias = Any  # a dataclass; every source has its own


class Kept:
    """History of one line.

    Parameters
    ----------
    folder : where it outlives the screen; None keeps it in memory, until the end.
    can_be_seen : whether somebody can acknowledge an alarm here.
    wall : returns wall time, s since 1970.
    """

    def __init__(
        self,
        folder: Path | None,
        clock: Clock,
        *,
        can_be_seen: bool = False,
        wall: Callable[[], float] = wall_time_s,
    ) -> None:
        self._clock = clock
        self.wall = wall
        self.store = Store(folder, (*events.SCHEMA, *TREND_SCHEMA))
        self.journal = Journal(self.store, clock, wall)
        if self.store.trouble:
            text = N_("history is not kept: {why}")
            self.journal.add(Kind.SERVICE, "HISTORY", text, why=self.store.trouble)
        self._refusals = Bucket(clock, per_s=0.1, burst=10.0)
        self.book = AlarmBook(clock, wall, can_be_seen=can_be_seen)
        self.trends = Trends(self.store, wall)
        self._shapes = ShapeHistory(self.trends, wall)
        self._columns: tuple[str, ...] = ()
        self._ring = ""
        self._looked_ns: int | None = None
        self._seen = Observed()
        self._layout = Layout()
        self._texts: dict[tuple[str, str], str] = {}
        self._parts: dict[str, Callable[[Say], Part]] = {
            ALARMS: self.alarms,
            ROLLS: lambda say: rolls_part(self._seen, say, self._shapes),
        }

    def join(self, topic: str, part: Callable[[Say], Part]) -> None:
        """Have frames of a topic carry what another source says."""
        self._parts[topic] = part

    @property
    def topics(self) -> tuple[str, ...]:
        """What a page may ask for in its frames."""
        return tuple(self._parts)

    @property
    def kinds(self) -> tuple[tuple[str, str], ...]:
        """Return every kind of event with its word, in English."""
        return tuple((kind.value, word) for kind, word in KINDS.items())

    @property
    def rolls(self) -> tuple[tuple[str, str], ...]:
        """Return every roll of the site with its label."""
        site = self._seen.site
        return tuple((one.name, label_of(one.name)) for one in site.rolls) if site else ()

    @property
    def windows(self) -> tuple[tuple[str, str], ...]:
        """Return every window of the trends with its word, in English."""
        return tuple(WINDOW_WORDS.items())

    def groups(self, say: Say) -> tuple[tuple[str, str], ...]:
        """Return every group of curves that is kept now, in the reader's language."""
        there = dict.fromkeys(one.group for one in self.trends.series if one.group != "state")
        ordered = [one for one in GROUPS if one in there]
        ordered += [one for one in there if one not in GROUPS]
        return tuple((group, group_name(group, say)) for group in ordered)

    def listen(self, news: News) -> None:
        """Take what a poll has brought."""
        self.book.hear(news.events)
        self.journal.listen(news)
        self._columns = news.columns
        self._ring = news.ring or self._ring
        self.trends.listen(news)

    @property
    def is_due(self) -> bool:
        """Whether a moment is looked at now: twice a second at most."""
        return self._looked_ns is None or self._clock.now_ns() - self._looked_ns >= LOOK_NS

    def look(self, seen: Observed, layout: Layout) -> None:
        """Take note of a moment, where one is due."""
        if not self.is_due:
            return
        self._looked_ns = self._clock.now_ns()
        self._seen, self._layout = seen, layout
        self._texts.clear()
        state = state_of(seen)
        is_fresh = seen.writer_lives and seen.tick_age_s is not None
        conditions = conditions_of(seen, state)
        self.book.look(
            (*conditions, _no_service(seen)) if state == GONE else conditions,
            is_known=is_fresh and seen.tick_age_s < FRESH_S,  # type: ignore[operator]
            is_active=state == State.ACTIVE.name,
        )
        for alarm in self.book.settled():
            self.journal.first_out(alarm, self._ring)
        self.journal.look(seen)
        self.trends.look(seen, layout, self._columns)
        self._shapes.look(seen)

    def recent(self) -> RecentPart:
        """Return the last ten minutes of what the overview shows."""
        return recent_part(self.trends, self._layout, self.wall())

    def part(self, topic: str, language: str) -> str:
        """Return what a page of a topic shows of the newest moment, as JSON."""
        key = (topic, language)
        if key not in self._texts:
            part = self._parts[topic](say_in(language))
            self._texts[key] = json.dumps(
                asdict(part), ensure_ascii=False, allow_nan=False, separators=(",", ":")
            )
        return self._texts[key]

    def person(self, what: str, who: str) -> None:
        """Write down what somebody did; of a flood of refused logins, some."""
        if what == LOGIN_REFUSED and not self._refusals.take():
            return
        self.journal.add(Kind.PERSON, "PERSON", PEOPLE.get(what, what), who=who)

    def close(self) -> None:
        """Write what waits, and close."""
        self.trends.flush()
        self.store.close()

    def alarms(self, say: Say) -> AlarmPart:
        """Return what is shown of alarms."""
        return alarm_part(self.book, self.journal.number, self.store.trouble, self.cycle_s, say)

    @property
    def cycle_s(self) -> float:
        """Period of the control cycle, s; NaN before it is known."""
        site = self._seen.site
        return site.cycle_s if site is not None else math.nan


def _no_service(seen: Observed) -> Condition:
    """Return the alarm that nothing is heard of the service, by whatever reason."""
    why, to_do = why_gone(seen)
    medium = RANK[Priority.MEDIUM]
    return Condition(
        key="SERVICE", rank=medium, name="SERVICE", text=why, to_do=to_do, delay_s=5.0
    )
