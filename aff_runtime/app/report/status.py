"""What ``status`` answers: the newest record of the ring as text, and how the service stands."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from aff_runtime.app.report.block_status import blocks
from aff_runtime.app.report.status_answer import SILENT, Alarm, Live, StatusAnswer
from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.base.events import BY_CODE, BY_NAME
from aff_runtime.base.signals import State, Status

if TYPE_CHECKING:
    from aff_runtime.config.models import Site

POWER_UP, BYPASSED = "POWER_UP", "BYPASSED"
PERMISSIVES = {
    "LINE_RUN": "the line does not run",
    "AFF_ENABLE_REQUEST": (
        "the PLC does not ask for the correction, or refused one: then bypass and arm"
    ),
    "REMOTE": "the line is in local",
    "WEB_INTACT": "the PLC sees no web",
    "TENSION_VALID": "the PLC calls the tension invalid",
    "ESTOP_OK": "an emergency stop is open",
}


def missing_permissive(status: int, need: Sequence[str]) -> str:
    """Return ``NAME=0`` of the first permissive that is not set, empty when all are."""
    for name in need:
        if not status & Status[name]:
            return f"{name}=0"
    return ""


def live_status(tick: TickRow, need: Sequence[str], site: Site) -> tuple[State, Live]:
    """Return a row of the ring as text and numbers; NaN becomes None.

    Parameters
    ----------
    tick : newest row.
    need : names of the permissives, in the order in which the first missing one is named.
    site : the site of the parameter record, for units and limits of the blocks.
    """
    return tick.state, replace(
        live_tick(tick),
        blocked_by=missing_permissive(tick.status_word, need),
        blocks=blocks(tick, site),
    )


def live_tick(tick: TickRow) -> Live:
    """Return what a row of the ring says without knowledge of its site."""
    event = BY_CODE.get(tick.alarm_code, BY_CODE[0])
    return Live(
        alarm=Alarm(code=event.code, name=event.name, text=event.text, action=event.action),
        comm=tick.outcome.name,
        signals={
            k: v if v is not None and math.isfinite(v) else None for k, v in tick.values.items()
        },
    )


def explain(blocked: str) -> str:
    """Return what stands against an armed output, with what it means and what to do."""
    name = blocked.split(" ", maxsplit=1)[0]
    if name in BY_NAME:
        event = BY_NAME[name]
        return f"{blocked}: {event.text}; {event.action}"
    lacks = name.removesuffix("=0")
    return f"{blocked}: {PERMISSIVES[lacks]}" if lacks in PERMISSIVES else blocked


def not_armed(state: State, blocked: str) -> str:
    """Return why an ``arm`` came to nothing, the state by the name that ``status`` gives it."""
    rests = state in (State.FAULT, State.BYPASS, State.READY)
    name = state.name if rests else f"{state.name}, READY"
    return f"{name}: blocked by {explain(blocked)}" if blocked else f"{state.name}: not armed"


NOTHING_AGAINST_IT = "nothing stands against it now: arm again"


def refused_arm(state: State, blocked: str) -> str:
    """Return why an ``arm`` was refused; what stood against it may be over by then."""
    said = not_armed(state, blocked)
    return said if blocked else f"{said}; {NOTHING_AGAINST_IT}"


def headline(answer: StatusAnswer) -> str:
    """Return the first line of ``aff-runtime status``: state, what blocks, what to do."""
    state, live = answer.state, answer.live or Live()
    line = state
    if state == SILENT:
        line = (
            f"{SILENT}: no tick for {answer.tick_age_s:.1f} s, what is shown is the last one; the "
            "PLC takes the correction back when the heartbeat stops; see the log"
        )
    elif state in (State.FAULT.name, State.BYPASS.name) and live.alarm.code:
        line = f"{state}: {_rest(live.alarm, live.blocked_by)}"
    elif live.blocked_by:
        line = not_armed(State[state], live.blocked_by) if state in State.__members__ else state
    if answer.config_differs:
        line += "  [CONFIG_DIFFERS]"
    return line


def _rest(alarm: Alarm, blocked: str) -> str:
    """Return why the output rests, what keeps it from being armed, and the operator's step."""
    why = alarm.text if alarm.name in (POWER_UP, BYPASSED) else f"{alarm.name}, {alarm.text}"
    if blocked.split(" ", maxsplit=1)[0] == alarm.name:
        # with the signal or the numbers, where it has them
        return f"{blocked}, {alarm.text}; {alarm.action}"
    if blocked:
        return f"{why}; blocked by {explain(blocked)}"
    over = "" if alarm.name in (POWER_UP, BYPASSED) else ", over now"
    return f"{why}{over}; {alarm.action}"
