"""Processes killed the hard way: zero at the plant, and nothing comes back by itself."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.hil.live_line import LiveLine
from tests.lockstep.fault_table import WORKING_M_S, ZERO_WITHIN_S, assert_never_above_limit, peak
from tests.processes import is_running, kill, until

pytestmark = [pytest.mark.hil, pytest.mark.wire, pytest.mark.timeout(90)]

QUIET_S = 1.5  # long enough for a restarted control process to do wrong


def _zero_from(line: LiveLine, killed_s: float, until_s: float) -> None:
    """The correction was at work before, and was zero in time and ever since."""
    rows = line.since(killed_s - 0.3)
    assert peak(rows, killed_s - 0.2, killed_s) > WORKING_M_S
    assert peak(rows, killed_s + ZERO_WITHIN_S, until_s) == 0.0
    assert_never_above_limit(rows)


def _kill_and_judge(line: LiveLine, kill_it: Callable[[], None]) -> None:
    line.ensure_active()
    kill_it()
    killed_s = line.now_s()
    line.wait_plant(killed_s + ZERO_WITHIN_S + QUIET_S)
    _zero_from(line, killed_s, killed_s + ZERO_WITHIN_S + QUIET_S)


def test_a_killed_control_process_is_restarted_idle(line: LiveLine):
    old = int(line.status()["control_pid"])
    _kill_and_judge(line, lambda: kill(old))
    until("another control process", lambda: line.status().get("comm") == "OK")
    assert line.status()["control_pid"] != old
    assert line.state == "FAULT"
    line.ensure_active()


@pytest.mark.campaign
def test_a_killed_supervisor_takes_the_correction_with_it(line: LiveLine):
    control = int(line.status()["control_pid"])
    _kill_and_judge(line, lambda: kill(line.service.process.pid))
    until("the control process ends by itself", lambda: not is_running(control))
    _comes_back_at_zero(line)


def test_a_killed_runtime_leaves_the_plc_to_take_it_to_zero(line: LiveLine):
    control = int(line.status()["control_pid"])
    trips = line.at_plant("status")["counts"]["watchdog_trips"]

    def kill_all() -> None:
        kill(control)
        kill(line.service.process.pid)

    _kill_and_judge(line, kill_all)
    assert line.at_plant("status")["counts"]["watchdog_trips"] > trips
    _comes_back_at_zero(line)


def _comes_back_at_zero(line: LiveLine) -> None:
    """A service started anew corrects nothing before an operator's edge."""
    started_s = line.now_s()
    line.start_again()
    until("the service sees the PLC", lambda: line.status().get("comm") == "OK")
    line.wait_plant(line.now_s() + 0.5)
    assert line.state == "FAULT"
    rows = line.since(started_s)
    assert peak(rows, started_s, rows[-1][0]) == 0.0
    line.ensure_active()
