"""When a scope stops: an edge, a level, a change of state, an event. Pure, over ticks in order."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from aff_hmi.scope.ticks import Cut
from aff_hmi.words import N_
from aff_runtime.base.events import BY_CODE, TABLE, Event, Reaction


class On(StrEnum):
    """What a trigger waits for; ``FIRST_OUT`` is an event that takes the correction out."""

    RISE = "rise"
    FALL = "fall"
    ABOVE = "above"
    BELOW = "below"
    STATE = "state"
    EVENT = "event"
    FIRST_OUT = "first_out"


WORDS = {
    On.RISE: N_("rises above a level"),
    On.FALL: N_("falls below a level"),
    On.ABOVE: N_("is above a level"),
    On.BELOW: N_("is below a level"),
    On.STATE: N_("the state changes"),
    On.EVENT: N_("an event of the service"),
    On.FIRST_OUT: N_("a fault takes the correction out"),
}
EVENTS = tuple(event.name for event in TABLE if event.code)
LEVELS = (On.RISE, On.FALL, On.ABOVE, On.BELOW)


@dataclass(frozen=True, slots=True, kw_only=True)
class Trigger:
    """What to wait for.

    Attributes
    ----------
    signal, level : where it is one of ``LEVELS``; the level is in the signal's unit.
    event : name of the only event that counts for ``On.EVENT``; empty for any.
    """

    on: On
    signal: str = ""
    level: float = 0.0
    event: str = ""


def places(cut: Cut, trigger: Trigger) -> NDArray[np.int64]:
    """Return every place at which a trigger fires, in order.

    An edge lies at the first tick beyond the level; a hole (NaN, or ticks that are missing) is no
    edge. A level holds at every tick beyond it.

    Raises
    ------
    KeyError
        When the signal is not kept.
    """
    if trigger.on in LEVELS:
        return _of_level(cut, trigger)
    if trigger.on is On.STATE:
        return np.flatnonzero(np.diff(cut.states) != 0) + 1
    codes = {code for code, event in BY_CODE.items() if code and _counts(event, trigger)}
    fired = sorted({tick for tick, code in cut.events if code in codes})
    found = np.searchsorted(cut.ticks, np.array(fired, dtype=np.int64))
    return found[found < len(cut)]


def _counts(event: Event, trigger: Trigger) -> bool:
    if trigger.on is On.EVENT:
        return trigger.event in ("", event.name)
    return event.reaction is Reaction.FADE_AND_LATCH


def _of_level(cut: Cut, trigger: Trigger) -> NDArray[np.int64]:
    values = cut.of(trigger.signal).astype(np.float64)
    is_up = trigger.on in (On.RISE, On.ABOVE)
    with np.errstate(invalid="ignore"):
        beyond = values >= trigger.level if is_up else values <= trigger.level
        before = values < trigger.level if is_up else values > trigger.level
    if trigger.on in (On.ABOVE, On.BELOW):
        return np.flatnonzero(beyond)
    follows = np.diff(cut.time_s) < 1.5 * cut.cycle_s
    return np.flatnonzero(before[:-1] & beyond[1:] & follows) + 1
