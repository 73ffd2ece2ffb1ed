"""What ``status`` answers: the newest record of the ring in words, and how the service stands."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from aff_runtime.app.report.block_status import blocks
from aff_runtime.base.events import BY_CODE, BY_NAME
from aff_runtime.base.signals import Outcome, State, Status

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


def describe(
    record: Mapping[str, float], need: Sequence[str], site: Mapping[str, Any] | None = None
) -> dict[str, Any]:
    """Return a ring record in words and numbers; NaN becomes None.

    Parameters
    ----------
    record : newest record by column name.
    need : names of the permissives, in the order in which the first missing one is named.
    site : the site of the parameter record, for units and limits of the blocks.
    """
    state = State(int(record["state"]))
    event = BY_CODE.get(int(record["alarm"]), BY_CODE[0])
    return {
        "state": state.name,
        "blocked_by": missing_permissive(int(record["status"]), need),
        "alarm": {
            "code": event.code,
            "name": event.name,
            "text": event.text,
            "action": event.action,
        },
        "blocks": [asdict(block) for block in blocks(record, site or {})],
        "comm": Outcome(int(record["outcome"])).name,
        "signals": {k: v if math.isfinite(v) else None for k, v in record.items()},
    }


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


def headline(answer: Mapping[str, Any]) -> str:
    """Return the first line of ``aff-runtime status``: state, what blocks, what to do."""
    state, blocked = str(answer.get("state", "STARTING")), str(answer.get("blocked_by", ""))
    alarm = answer.get("alarm", {})
    line = state
    if state in (State.FAULT.name, State.BYPASS.name) and alarm.get("code"):
        line = f"{state}: {_rest(alarm, blocked)}"
    elif blocked:
        line = not_armed(State[state], blocked) if state in State.__members__ else state
    if answer.get("config_differs"):
        line += "  [CONFIG_DIFFERS]"
    return line


def _rest(alarm: Mapping[str, Any], blocked: str) -> str:
    """Return why the output rests, what keeps it from being armed, and the operator's step."""
    name, text, action = str(alarm["name"]), str(alarm["text"]), str(alarm["action"])
    why = text if name in (POWER_UP, BYPASSED) else f"{name}, {text}"
    if blocked.split(" ", maxsplit=1)[0] == name:
        return f"{why}; {action}"
    if blocked:
        return f"{why}; blocked by {explain(blocked)}"
    return f"{why}; {action}" if name in (POWER_UP, BYPASSED) else f"{why}, over now; {action}"
