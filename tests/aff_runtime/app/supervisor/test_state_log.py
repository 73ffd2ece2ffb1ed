"""What the service's log says of states and alarms."""

from __future__ import annotations

import logging

import pytest

from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.app.supervisor.state_log import StateLog
from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import State


def parameters(state: State, alarm: str = "NONE") -> TickRow:
    return TickRow({"state": float(state), "alarm": float(BY_NAME[alarm].code)})


def test_a_fault_is_a_warning_with_what_to_do(caplog: pytest.LogCaptureFixture) -> None:
    log = StateLog()
    with caplog.at_level(logging.INFO):
        log.step(parameters(State.ACTIVE))
        log.step(parameters(State.FAULT, "PLC_STALE"))
    assert [r.levelno for r in caplog.records] == [logging.INFO, logging.WARNING]
    assert caplog.messages[1].startswith("ACTIVE -> FAULT: PLC_STALE, PLC data is stale; check")


def test_nothing_is_said_twice_and_another_alarm_is_said(caplog: pytest.LogCaptureFixture) -> None:
    log = StateLog()
    with caplog.at_level(logging.INFO):
        for alarm in ("PLC_STALE", "PLC_STALE", "OVERRUN"):
            log.step(parameters(State.FAULT, alarm))
        log.step(None)
    assert len(caplog.messages) == 2
    assert "OVERRUN" in caplog.messages[1]


def test_an_alarm_that_comes_and_goes_while_bypassed_is_one_warning(
    caplog: pytest.LogCaptureFixture,
) -> None:
    log = StateLog()
    with caplog.at_level(logging.INFO):
        for alarm in ("BYPASSED", "APPLIED_DIFFERS", "APPLIED_DIFFERS", "BYPASSED"):
            log.step(parameters(State.BYPASS, alarm))
    assert [r.levelno for r in caplog.records] == [logging.INFO, logging.WARNING, logging.INFO]
    assert caplog.messages[1].startswith("BYPASS: APPLIED_DIFFERS, the PLC adds a correction")


def test_a_start_and_a_bypass_are_no_warnings(caplog: pytest.LogCaptureFixture) -> None:
    log = StateLog()
    with caplog.at_level(logging.INFO):
        log.step(parameters(State.FAULT, "POWER_UP"))
        log.step(parameters(State.READY))
        log.step(parameters(State.BYPASS, "BYPASSED"))
        log.restart()
        log.step(parameters(State.FAULT, "POWER_UP"))
    assert {r.levelno for r in caplog.records} == {logging.INFO}
    assert len(caplog.messages) == 4
