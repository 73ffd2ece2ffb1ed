"""One picture of a scope: which ticks, by an end or by a trigger, and as bytes or as a table."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from aff_hmi.scope.ticks import Cut
from aff_hmi.scope.trigger import EVENTS, LEVELS, On, Trigger, places
from aff_runtime.base.numbers import finite_or_none

SECONDS = (1, 2, 5, 10, 20)
PRE_PERCENT = (0, 20, 50, 80, 100)
MOST_SIGNALS = 8
MOST_IN_SHOT = 20_000
LONGEST = 100


@dataclass(frozen=True, slots=True, kw_only=True)
class ShotRequest:
    """What a page wants of a scope.

    Attributes
    ----------
    names : signals, ``MOST_SIGNALS`` at most. ``roll`` : whose turns go with it, empty for none.
    end : number of the last tick; -1 for the newest.
    trigger : None for what is there now. ``after`` : tick after which it counts.
    pre_percent : share of the window before the trigger.
    kept : number of a window that is kept; 0 for what arrives.
    wants_lines : whether the strongest frequencies go with it.
    """

    names: tuple[str, ...]
    seconds: int = 5
    roll: str = ""
    end: int = -1
    trigger: Trigger | None = None
    after: int = -1
    pre_percent: int = 20
    kept: int = 0
    wants_lines: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Shot:
    """Ticks that are shown; ``at`` : place of the trigger in them, None without one."""

    cut: Cut
    at: int | None = None


def asked_of(query: Mapping[str, str]) -> ShotRequest | None:
    """Return what a request wants; None for what is no request of ours."""
    names = tuple(filter(None, query.get("signals", "").split(",")))[: MOST_SIGNALS + 1]
    texts = (*names, query.get("roll", ""), query.get("of", ""))
    numbers = {
        name: _whole(query.get(name, str(default)))
        for name, default in (("seconds", 5), ("end", -1), ("after", -1), ("kept", 0), ("pre", 20))
    }
    on, level = query.get("on", ""), _real(query.get("level", "0"))
    is_right = (
        len(set(names)) == len(names) <= MOST_SIGNALS
        and all(len(text) <= LONGEST for text in texts)
        and None not in numbers.values()
        and numbers["seconds"] in SECONDS
        and numbers["pre"] in PRE_PERCENT
        and on in ("", *On)
        and query.get("event", "") in ("", *EVENTS)
        and level is not None
    )
    if not is_right:
        return None
    seconds, end, after, kept, pre = (int(numbers[one] or 0) for one in numbers)
    return ShotRequest(
        names=names,
        seconds=seconds,
        roll=query.get("roll", ""),
        end=end,
        trigger=Trigger(
            on=On(on), signal=query.get("of", ""), level=level or 0.0, event=query.get("event", "")
        )
        if on
        else None,
        after=after,
        pre_percent=pre,
        kept=kept,
        wants_lines=query.get("lines", "") == "1",
    )


def _whole(text: str) -> int | None:
    digits = text.removeprefix("-")
    is_number = digits.isascii() and digits.isdigit() and len(text) <= 15
    return int(text) if is_number else None


def _real(text: str) -> float | None:
    try:
        value = float(text) if len(text) <= 30 else math.nan
    except ValueError:
        return None
    return finite_or_none(value)


def count_of(asked: ShotRequest, cycle_s: float) -> int:
    """Return how many ticks a whole shot has."""
    return min(MOST_IN_SHOT, max(2, round(asked.seconds / cycle_s))) if cycle_s > 0.0 else 2


def shot_of(cut: Cut, asked: ShotRequest) -> Shot | None:
    """Return the ticks that are wanted; None while a trigger has not fired, or is not whole yet.

    Raises
    ------
    KeyError
        When the trigger's signal is not kept.
    """
    count = count_of(asked, cut.cycle_s)
    if asked.trigger is None:
        end = len(cut)
        if asked.end >= 0:
            end = int(np.searchsorted(cut.ticks, asked.end, side="right"))
        return Shot(cut=cut.part(max(0, end - count), end))
    before = min(count - 1, round(0.01 * asked.pre_percent * count))
    fired = places(cut, asked.trigger)
    fired = fired[cut.ticks[fired] > asked.after]
    if asked.trigger.on in LEVELS:  # what happened is shown with what there is before it
        fired = fired[fired >= before]
    if not len(fired):
        return None
    at = int(fired[0])
    begin, end = max(0, at - before), at - before + count
    return Shot(cut=cut.part(begin, end), at=at - begin) if end <= len(cut) else None
