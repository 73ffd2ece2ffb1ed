"""What the page of alarms and events shows of a moment, in the reader's language."""

from __future__ import annotations

import math
from dataclasses import dataclass

from aff_hmi.notices import filled
from aff_hmi.see.alarm import Alarm, Life
from aff_hmi.see.alarm_book import AlarmBook
from aff_hmi.see.events import KeptEvent, Kind
from aff_hmi.words import N_, Say, figures_in
from aff_runtime.base.printable import printable

AROUND_S = 5.0  # of ticks before an event and after it
LIVES = {
    Life.ACTIVE: N_("active"),
    Life.SEEN: N_("active, seen"),
    Life.GONE: N_("over, not seen yet"),
    Life.SHELVED: N_("shelved"),
}
KINDS = {
    Kind.ALARM: N_("alarm"),
    Kind.STATE: N_("state"),
    Kind.ROLL: N_("roll"),
    Kind.SETTINGS: N_("settings"),
    Kind.SERVICE: N_("service"),
    Kind.PERSON: N_("person"),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class AlarmLine:
    """One alarm as it is shown; words are translated, times are wall time in s.

    Attributes
    ----------
    led_by : what had taken the correction out before it; empty for nothing.
    page : what this screen shows of it: its ticks, its roll, the machine; empty for nothing.
    """

    key: str
    rank: int
    name: str
    text: str
    to_do: str
    life: str
    life_word: str
    since_s: float
    gone_s: float | None
    tick: int | None
    times: int
    is_first: bool
    led_by: str
    followers: tuple[str, ...]
    seen_by: str
    shelved: str
    can_shelve: bool
    page: str


@dataclass(frozen=True, slots=True, kw_only=True)
class AlarmPart:
    """What changes on the page.

    Attributes
    ----------
    load : sentence on how many alarms came. ``is_flood`` : more than a person can follow.
    newest : number of the newest event; the page asks for events when it changes.
    history : what is wrong with the history, empty for nothing.
    """

    alarms: tuple[AlarmLine, ...]
    load: str
    is_flood: bool
    newest: int
    history: str


def alarm_part(book: AlarmBook, newest: int, history: str, cycle_s: float, say: Say) -> AlarmPart:
    """Return the part of a frame that is of alarms and events.

    Parameters
    ----------
    cycle_s : period of the control cycle; NaN where it is not known.
    """
    load = book.load()
    words = say(
        N_("alarms in ten minutes: {ten}; in a day: {high} high, {medium} medium, {low} low")
    )
    high, medium, low = load.day
    return AlarmPart(
        alarms=tuple(_line(one, cycle_s, say) for one in book.shown()),
        load=words.format(ten=load.ten_minutes, high=high, medium=medium, low=low),
        is_flood=load.is_flood,
        newest=newest,
        history=say(N_("history is not kept: {why}")).format(why=printable(history, 120))
        if history
        else "",
    )


def _line(alarm: Alarm, cycle_s: float, say: Say) -> AlarmLine:
    one = alarm.condition
    after = say(N_("{name} {seconds} s after"))
    followers = [(f.name, figures_in(f"{f.after_s:.3f}", say)) for f in alarm.followers]
    shelved = say(N_("by {name}: {reason}"))
    return AlarmLine(
        key=one.key,
        rank=one.rank,
        name=one.name,
        text=filled(one.text, one.values, say),
        to_do=say(one.to_do),
        life=alarm.life,
        life_word=say(LIVES[alarm.life]),
        since_s=round(alarm.since_s, 3),
        gone_s=None if alarm.gone_s is None else round(alarm.gone_s, 3),
        tick=alarm.tick,
        times=alarm.times,
        is_first=alarm.is_first and alarm.led_by is None,
        led_by=_led_by(alarm, say),
        followers=tuple(after.format(name=name, seconds=late) for name, late in followers),
        seen_by=alarm.seen_by,
        shelved=shelved.format(name=alarm.shelved_by, reason=alarm.reason)
        if alarm.shelved_until_ns
        else "",
        can_shelve=one.rank != 1 and alarm.life is not Life.GONE,
        page=_page(alarm, cycle_s),
    )


def _led_by(alarm: Alarm, say: Say) -> str:
    if not alarm.is_first or alarm.led_by is None:
        return ""
    words = say(N_("the correction was taken out before it, by {name}, {seconds} s earlier"))
    before = figures_in(f"{alarm.led_by.before_s:.3f}", say)
    return words.format(name=alarm.led_by.name, seconds=before)


def _page(alarm: Alarm, cycle_s: float) -> str:
    """Return where more is shown: of an event, the ticks around it."""
    return ticks_page(alarm.tick, alarm.since_s, cycle_s) or alarm.condition.page


def ticks_page(tick: int | None, utc_s: float, cycle_s: float) -> str:
    """Return where the ticks around an event are shown; empty where it has none."""
    if tick is None or not cycle_s > 0.0:
        return ""
    return f"/scope?end={tick + round(AROUND_S / cycle_s)}&tick={tick}&at={utc_s:.3f}"


@dataclass(frozen=True, slots=True, kw_only=True)
class EventLine:
    """One event as it is shown."""

    number: int
    utc_s: float
    tick: int | None
    kind: str
    roll: str
    name: str
    text: str
    who: str
    page: str


def event_line(entry: KeptEvent, say: Say, cycle_s: float = math.nan) -> EventLine:
    """Return an event in the reader's language; ``cycle_s`` : NaN where it is not known."""
    return EventLine(
        number=entry.number,
        utc_s=entry.utc_s,
        tick=entry.tick,
        kind=say(KINDS[entry.kind]),
        roll=entry.roll,
        name=entry.name,
        text=filled(entry.text, entry.values, say),
        who=entry.who,
        page=ticks_page(entry.tick, entry.utc_s, cycle_s),
    )
