"""Puts every change of state and alarm into the service's log, with the operator's step."""

from __future__ import annotations

import logging

from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.base.events import BY_CODE, BY_NAME
from aff_runtime.base.signals import LATCHED_STATES, State

LOG = logging.getLogger("aff_runtime")
QUIET = frozenset(BY_NAME[name].code for name in ("NONE", "POWER_UP", "BYPASSED"))


class StateLog:
    """Compares the newest ring record with the one before; one line per change."""

    def __init__(self) -> None:
        self._state: State | None = None
        self._alarm = 0

    def restart(self) -> None:
        """Forget what was seen: another control process begins."""
        self._state, self._alarm = None, 0

    def step(self, tick: TickRow | None) -> None:
        """Log what has changed since the last call; nothing while there is no record."""
        if tick is None:
            return
        state, alarm = tick.state, tick.alarm_code
        if (state, alarm) == (self._state, self._alarm):
            return
        event = BY_CODE.get(alarm, BY_CODE[0])
        rests = state in LATCHED_STATES and event.code != 0
        level = logging.WARNING if rests and event.code not in QUIET else logging.INFO
        if state is not self._state:
            before = "" if self._state is None else f"{self._state.name} -> "
            tail = f": {event.name}, {event.text}; {event.action}" if rests else ""
            LOG.log(level, "%s%s%s", before, state.name, tail)
        elif rests:
            LOG.log(level, "%s: %s, %s; %s", state.name, event.name, event.text, event.action)
        self._state, self._alarm = state, alarm
