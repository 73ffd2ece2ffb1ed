"""Faults of the table and killed processes, over a real socket: zero at the plant, and no return.

Quick is the runtime that is killed as a whole, once on real plant, wire and service. The rest is
quick in virtual time, ``tests/lockstep/test_faults.py``, and on a PLC of its own,
``tests/aff_runtime/app/test_commissioning_kills.py``.

Faults and kills share one plant and one service: to start both takes 8 s of a core.
"""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.hil.live_line import LiveLine, Pauses
from tests.lockstep.fault_table import (
    LASTS_S,
    TROUBLES,
    WORKING_M_S,
    ZERO_WITHIN_S,
    Trouble,
    assert_never_above_limit,
    peak,
)
from tests.processes import is_running, kill, until

pytestmark = [pytest.mark.hil, pytest.mark.wire, pytest.mark.timeout(90)]

ATTEMPTS = 4
HELD_UP_SAMPLES = 4  # 20 ms: a pause of the machine on top of the fault is a second fault
QUIET_S = 0.4
WATCHED_S = 1.5  # after a kill: long enough for a restarted control process to do wrong


@pytest.mark.long
@pytest.mark.parametrize("name", TROUBLES)
def test_fault_takes_the_correction_to_zero_and_only_an_edge_brings_it_back(
    line: LiveLine, name: str
):
    trouble = TROUBLES[name]
    for attempt in range(ATTEMPTS):
        before = line.pauses()
        start_s = _let_it_happen(line, trouble)
        rows = line.since(start_s - 0.3)
        at_work = peak(rows, start_s - 0.1, start_s) > WORKING_M_S
        zero = peak(rows, start_s + ZERO_WITHIN_S, start_s + LASTS_S) == 0.0
        last = attempt == ATTEMPTS - 1
        if last or (at_work and (zero or not _disturbed(before, line.pauses(), trouble))):
            break
        line.ensure_active()
    assert at_work
    assert zero, [row for row in rows if row[0] > start_s + ZERO_WITHIN_S][:3]
    assert_never_above_limit(rows)
    if trouble.latched:
        _stays_at_zero_until_the_operators_edge(line, trouble, start_s)
    until("the correction is back", line.is_working, 10.0)


def _let_it_happen(line: LiveLine, trouble: Trouble) -> float:
    """Inject the fault, wait for its end; return its start in plant time, s."""
    start_s = float(line.at_plant(f"fault {trouble.at(0.1)}")["start_s"])
    line.wait_plant(start_s + 0.6 * LASTS_S)
    assert line.alarm == trouble.alarm or not trouble.latched
    line.wait_plant(start_s + LASTS_S + 0.02)
    return start_s


def _stays_at_zero_until_the_operators_edge(
    line: LiveLine, trouble: Trouble, start_s: float
) -> None:
    line.wait_plant(start_s + LASTS_S + QUIET_S)
    assert line.state == "FAULT"
    assert line.alarm == trouble.alarm
    assert peak(line.since(start_s + LASTS_S), start_s + LASTS_S, 1e9) == 0.0
    until("the service sees the PLC again", lambda: line.status()["comm"] == "OK")
    line.ensure_active()


def _disturbed(before: Pauses, after: Pauses, trouble: Trouble) -> bool:
    """Return whether the machine held a process up during the scenario."""
    return (
        after.watchdog_trips - before.watchdog_trips > trouble.trips
        or after.plant_samples - before.plant_samples >= HELD_UP_SAMPLES
        or after.runtime_ticks - before.runtime_ticks >= HELD_UP_SAMPLES
    )


# --- processes that are killed ---------------------------------------------------------------


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
    line.wait_plant(killed_s + ZERO_WITHIN_S + WATCHED_S)
    _zero_from(line, killed_s, killed_s + ZERO_WITHIN_S + WATCHED_S)


@pytest.mark.long
def test_a_killed_control_process_is_restarted_idle(line: LiveLine):
    old = int(line.status()["control_pid"])
    _kill_and_judge(line, lambda: kill(old))
    until("another control process", lambda: line.status().get("comm") == "OK")
    assert line.status()["control_pid"] != old
    assert line.state == "FAULT"
    line.ensure_active()


@pytest.mark.long
def test_a_killed_supervisor_takes_the_correction_with_it(line: LiveLine):
    control = int(line.status()["control_pid"])
    _kill_and_judge(line, lambda: kill(line.service.process.pid))
    until("the control process ends by itself", lambda: not is_running(control))
    _comes_back_at_zero(line)


def test_a_killed_runtime_leaves_the_plc_to_take_it_to_zero(line: LiveLine):
    control = int(line.status()["control_pid"])
    trips = line.at_plant("status")["counts"]["watchdog_trips"]
    _kill_and_judge(line, lambda: _kill_all(line, control))
    assert line.at_plant("status")["counts"]["watchdog_trips"] > trips


# quick: app/test_service.py, its start in FAULT with zero on the wire
@pytest.mark.long
def test_a_runtime_started_anew_corrects_nothing_before_an_operators_edge(line: LiveLine):
    _kill_all(line, int(line.status()["control_pid"]))
    line.wait_plant(line.now_s() + ZERO_WITHIN_S)
    _comes_back_at_zero(line)


def _kill_all(line: LiveLine, control: int) -> None:
    kill(control)
    kill(line.service.process.pid)


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
