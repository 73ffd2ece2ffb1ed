"""Why the correction is as it is, and what to do: the words of ``status``, translated."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from aff_hmi.objections import translated
from aff_hmi.words import N_, Say, figures_in
from aff_runtime.app.report.status import BYPASSED, PERMISSIVES, POWER_UP
from aff_runtime.base.events import BY_CODE, BY_NAME, Event
from aff_runtime.base.signals import State

STARTING = "STARTING"
# shape beside the word: nobody has to tell colours apart
SHAPES = {
    State.ACTIVE.name: "●",
    State.ARMED.name: "◐",
    State.FADING.name: "◒",
    State.READY.name: "○",
    State.OFF.name: "○",
    State.SHADOW.name: "◌",
    State.BYPASS.name: "■",
    State.FAULT.name: "▲",
}
MEANS = {
    State.ACTIVE.name: N_("the correction goes out"),
    State.ARMED.name: N_("armed; waits for the line speed"),
    State.FADING.name: N_("the correction is on its way to zero"),
    State.READY.name: N_("everything is there, nobody has armed"),
    State.OFF.name: N_("a permissive is missing"),
    State.SHADOW.name: N_("computed and recorded; zero is sent"),
    State.BYPASS.name: N_("an operator took the correction back"),
    State.FAULT.name: N_("the correction is zero and stays so until somebody arms"),
    STARTING: N_("the service starts"),
}
TO_DO = {
    State.READY.name: N_("arm when the line is ready"),
    State.ARMED.name: N_("nothing; it begins with the line"),
    State.ACTIVE.name: N_("nothing"),
    State.SHADOW.name: N_("nothing; shadow off lets it be armed"),
    STARTING: N_("wait"),
}
# an output that is zero because nobody has armed yet, or somebody took it back: no alarm
CALM = (POWER_UP, BYPASSED)
# states that last until somebody arms
RESTING = (State.FAULT.name, State.BYPASS.name)


@dataclass(frozen=True, slots=True, kw_only=True)
class Reason:
    """Why, and the operator's step; both translated."""

    why: str
    to_do: str


def reason_of(
    state: str,
    alarm: int,
    blocked: str,
    say: Say,
    standing: Mapping[str, str] = MappingProxyType({}),
) -> Reason:
    """Return why the output is as it is.

    Parameters
    ----------
    state : name of the guard's state, or ``STARTING``.
    alarm : code of the alarm that stands.
    blocked : what stands against an armed output.
    standing : alarms that stand, with the signal that the guard named, by their event's name.
    """
    event = BY_CODE.get(alarm, BY_CODE[0])
    if state in RESTING and event.code:
        return _resting(event, blocked, say, standing.get(event.name, event.name))
    if (
        blocked
        and state in State.__members__
        and state not in (State.ACTIVE.name, State.ARMED.name)
    ):
        why, to_do = explained(blocked, say)
        return Reason(why=f"{say(N_('blocked by'))} {why}", to_do=to_do)
    if state == State.FADING.name and event.code:
        return Reason(why=f"{say(MEANS[state])}: {say(event.text)}", to_do=say(event.action))
    means = MEANS.get(state, "")
    return Reason(why=say(means) if means else state, to_do=say(TO_DO.get(state, "")) or "")


def _resting(event: Event, blocked: str, say: Say, name: str) -> Reason:
    """Return why an output rests, and what keeps it from being armed."""
    text = say(event.text)
    why = text if event.name in CALM else f"{name}: {text}"
    if blocked.split(" ", maxsplit=1)[0] == event.name:
        return Reason(why=f"{figures_in(blocked, say)}: {text}", to_do=say(event.action))
    if not blocked:
        over = "" if event.name in CALM else f" ({say(N_('over now'))})"
        return Reason(why=f"{why}{over}", to_do=say(event.action))
    against, to_do = explained(blocked, say)
    return Reason(why=f"{why}; {say(N_('blocked by'))} {against}", to_do=to_do)


def explained(blocked: str, say: Say) -> tuple[str, str]:
    """Return what stands against an armed output, and what to do about it."""
    name = blocked.split(" ", maxsplit=1)[0]
    if name in BY_NAME:
        event = BY_NAME[name]
        return f"{figures_in(blocked, say)}: {say(event.text)}", say(event.action)
    lacks = name.removesuffix("=0")
    if lacks in PERMISSIVES:
        to_do = say(N_("it comes from the PLC: look there for what is missing"))
        return f"{blocked}: {say(PERMISSIVES[lacks])}", to_do
    return translated(blocked, say) or (blocked, say(N_("clear what stands against it, then arm")))
