"""Step 9: each candidate is tried by the service, which takes it back by itself."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from aff_runtime.app.card.evidence import CheckedSite, Evidence, Try
from aff_runtime.app.card.measure.proof import MEMORIES, SETTLES, TURNS, enabled
from aff_runtime.app.card.measure.search import (
    Candidate,
    candidate,
    next_factor,
    text_with,
    values_of,
)
from aff_runtime.app.card.typed_values import TypedValues
from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.link.settings_answer import RETURNED, SettingsAnswer
from aff_runtime.app.report.comparison.window import load_window
from aff_runtime.app.report.status_answer import StatusAnswer, read_answer
from aff_runtime.base.errors import RefusedError
from aff_runtime.base.events import BY_NAME
from aff_runtime.base.ports import Clock
from aff_runtime.base.runs.window import RunWindow
from aff_runtime.base.signals import State

LEAST_S, WRITTEN_S, LOOK_NS = 10.0, 1.0, 500_000_000
"""Shortest window of a candidate; until its last rows are written; between two looks."""
LONGEST_S = 3600.0
"""To settle and to be looked at; a candidate that would take longer ends the search."""
RIPPLE_ROSE = BY_NAME["RIPPLE_ROSE"].name
Ask = Callable[..., Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class Tried:
    """What was tried, and the window of each try that ran to its end."""

    tries: tuple[Try, ...]
    windows: tuple[RunWindow, ...]


def search(
    actuator: str,
    parameters: ParameterRecord,
    checked: CheckedSite,
    ask: Ask,
    clock: Clock,
    say: Callable[[str], None],
) -> Tried:
    """Try one candidate after the other until the search is over.

    Parameters
    ----------
    ask : one request to the service.
    clock : how long to wait. ``say`` : hears how it goes.

    Raises
    ------
    RefusedError
        The correction is not on, or the service refuses a try.
    """
    tries, windows, table = list[Try](), list[RunWindow](), list[Candidate]()
    while (factor := next_factor(table)) is not None:
        settle_s, look_s = _times_s(parameters, actuator, factor, read_answer(ask("status")))
        say(f"{factor:g} of the present setting: {settle_s + look_s:.0f} s")
        if factor < 1.0:
            values = {path: factor * v for path, v in values_of(checked.site, actuator).items()}
            seconds = settle_s + look_s + 4.0 * WRITTEN_S
            why = f"card, step 9: {actuator} at {factor:g} of its setting"
            text = text_with(parameters.site_text, values)
            ask("settings", act="try", text=text, seconds=seconds, why=why)
        end = _watch(ask, clock, settle_s, look_s, tried=factor < 1.0)
        window = end.window
        if factor < 1.0 and window is not None:
            ask("settings", act="undo", why=f"card, step 9: {factor:g} is measured")
        one = Try(
            actuator=actuator,
            factor=factor,
            measured=window is not None,
            ended=end.why,
            worse=end.worse,
        )
        seen = load_window(window) if window is not None else None
        table.append(candidate(Evidence(checked=checked, typed=TypedValues(())), one, seen))
        tries.append(one)
        windows += [window] if window is not None else []
    return Tried(tries=tuple(tries), windows=tuple(windows))


def _times_s(
    parameters: ParameterRecord, actuator: str, factor: float, answer: StatusAnswer
) -> tuple[float, float]:
    """Return how long a candidate settles, and how long it is looked at."""
    if answer.state != State.ACTIVE.name or answer.live is None:
        raise RefusedError(f"the correction is not on: the service is {answer.state}; arm it")
    site, values = parameters.site, values_of(parameters.site, actuator)
    speed = abs(answer.live.tick.number(site.line.speed))
    given = site.actuators[actuator]
    rolls = [site.rolls[block.roll] for block in enabled(given)]
    radius_m = max(roll.largest_radius_m for roll in rolls)
    turn_s = math.tau * radius_m / speed if speed > 0.0 else math.inf
    look_s = max(LEAST_S, TURNS * turn_s)
    value = factor * max(values.values())
    settle_s = MEMORIES * value * turn_s if given.uses_shape else SETTLES * value
    if not settle_s + look_s < LONGEST_S:
        raise RefusedError("the line stands or is too slow for a search")
    return settle_s, look_s


@dataclass(frozen=True, slots=True, kw_only=True)
class _End:
    """How a candidate ended: with the window that it was looked at in, or why before.

    ``worse`` : ripple rose while it was tried.
    """

    window: RunWindow | None = None
    why: str = ""
    worse: bool = False


def _watch(ask: Ask, clock: Clock, settle_s: float, look_s: float, *, tried: bool) -> _End:
    """Wait until a candidate has been looked at, or has ended before."""
    live = read_answer(ask("status")).live
    begin_s = live.tick.time_s if live is not None else math.nan
    from_s = begin_s + settle_s
    while True:
        clock.sleep_until_ns(clock.now_ns() + LOOK_NS)
        answer = read_answer(ask("status"))
        now_s = answer.live.tick.time_s if answer.live is not None else math.nan
        if answer.state != State.ACTIVE.name or not now_s >= begin_s:
            return _taken_back(answer, tried=tried)
        if tried and not answer.trying:
            return _returned(SettingsAnswer.from_json(ask("settings", act="history")))
        if now_s >= from_s + look_s + WRITTEN_S:
            if answer.recorder is None:
                raise RefusedError("nothing is recorded: no search")
            folder = Path(answer.recorder.folder)
            return _End(window=RunWindow(folder=folder, from_s=from_s, to_s=from_s + look_s))


def _taken_back(answer: StatusAnswer, *, tried: bool) -> _End:
    """Return why the correction is not on any more."""
    alarm = answer.live.alarm.name if answer.live is not None else ""
    why = f"the correction was taken back: {answer.state}{f', {alarm}' if alarm else ''}"
    return _End(why=why, worse=tried and alarm == RIPPLE_ROSE)


def _returned(answer: SettingsAnswer) -> _End:
    """Return why the service has taken a try back, in the words of its history."""
    last = next((one for one in reversed(answer.versions) if one.verb == RETURNED), None)
    if last is None:
        return _End(why="the former settings returned")
    return _End(why=f"the former settings returned: {last.why}", worse=last.ripple_rose)
