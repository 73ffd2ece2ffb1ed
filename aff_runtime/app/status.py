"""What ``status`` answers: the newest record of the ring in words, and how the service stands."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from aff_runtime.base.events import BY_CODE
from aff_runtime.base.signals import Outcome, State, Status


def missing_permissive(status: int, need: Sequence[str]) -> str:
    """Return ``NAME=0`` of the first permissive that is not set, empty when all are."""
    for name in need:
        if not status & Status[name]:
            return f"{name}=0"
    return ""


def describe(record: Mapping[str, float], need: Sequence[str]) -> dict[str, Any]:
    """Return a ring record in words and numbers; NaN becomes None.

    Parameters
    ----------
    record : newest record by column name.
    need : names of the permissives, in the order in which the first missing one is named.
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
        "comm": Outcome(int(record["outcome"])).name,
        "signals": {k: v if math.isfinite(v) else None for k, v in record.items()},
    }


def headline(answer: Mapping[str, Any]) -> str:
    """Return the first line of ``aff-runtime status``."""
    state, blocked = str(answer.get("state", "STARTING")), str(answer.get("blocked_by", ""))
    alarm = answer.get("alarm", {})
    line = state
    if state == State.FAULT.name and alarm.get("code"):
        line += f": {alarm['name']} ({alarm['text']}; {alarm['action']})"
    elif blocked:
        line = f"{state}, READY: blocked by {blocked}"
    if answer.get("config_differs"):
        line += "  [CONFIG_DIFFERS]"
    return line
