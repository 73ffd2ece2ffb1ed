"""Every fault of the table between real processes over a real socket, judged at the plant."""

from __future__ import annotations

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
from tests.processes import until

pytestmark = [pytest.mark.hil, pytest.mark.wire, pytest.mark.timeout(90)]

ATTEMPTS = 4
HELD_UP_SAMPLES = 4  # 20 ms: a pause of the machine on top of the fault is a second fault
QUIET_S = 0.4


def one_of_each_alarm() -> list:
    """Return all troubles; of each alarm the first is quick, the others are of the campaign."""
    seen: set[str] = set()
    rows = []
    for name, trouble in TROUBLES.items():
        marks = (pytest.mark.campaign,) if trouble.alarm in seen else ()
        seen.add(trouble.alarm)
        rows.append(pytest.param(name, marks=marks, id=name))
    return rows


@pytest.mark.parametrize("name", one_of_each_alarm())
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
