"""Puts every change of state and alarm into the service's log, with the operator's step."""

from __future__ import annotations

import logging
from collections.abc import Mapping

from aff_runtime.base.events import BY_CODE, BY_NAME
from aff_runtime.base.signals import State

LOG = logging.getLogger("aff_runtime")
QUIET = frozenset(BY_NAME[name].code for name in ("NONE", "POWER_UP", "BYPASSED"))
RESTING = frozenset({State.FAULT, State.BYPASS})


class StateLog:
    """Compares the newest ring record with the one before; one line per change."""

    def __init__(self) -> None:
        self._state: State | None = None
        self._alarm = 0

    def restart(self) -> None:
        """Forget what was seen: another control process begins."""
        self._state, self._alarm = None, 0

    def step(self, record: Mapping[str, float] | None) -> None:
        """Log what has changed since the last call; nothing while there is no record."""
        if record is None:
            return
        state, alarm = State(int(record["state"])), int(record["alarm"])
        if (state, alarm) == (self._state, self._alarm):
            return
        event = BY_CODE.get(alarm, BY_CODE[0])
        rests = state in RESTING and event.code != 0
        level = logging.WARNING if rests and event.code not in QUIET else logging.INFO
        if state is not self._state:
            before = "" if self._state is None else f"{self._state.name} -> "
            tail = f": {event.name}, {event.text}; {event.action}" if rests else ""
            LOG.log(level, "%s%s%s", before, state.name, tail)
        elif rests:
            LOG.log(level, "%s: %s, %s; %s", state.name, event.name, event.text, event.action)
        self._state, self._alarm = state, alarm
