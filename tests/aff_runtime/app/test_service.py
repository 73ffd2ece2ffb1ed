"""The service as real processes against a PLC on loopback."""

from __future__ import annotations

import contextlib
import math
import os
import signal
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from aff_runtime.app.door.client import DoorClient
from aff_runtime.app.door.messages import DoorMessage, Facts, RingPassed
from aff_runtime.base.errors import RefusedError
from aff_runtime.base.runs.table import read_table
from aff_runtime.base.runs.window import run_window
from aff_runtime.core.response import Provenance, Response, ResponsePoint
from aff_runtime.telemetry.ring import RingReader
from tests.aff_runtime.app.fake_plc import GAIN_N_PER_M_S, READY_STATUS
from tests.aff_runtime.app.service_run import ServiceRun
from tests.aff_runtime.app.test_commissioning_kills import Asked, on_the_wire
from tests.doubles.run_reader import read_run
from tests.processes import is_running, kill, pause, until

pytestmark = pytest.mark.wire
WEB_INTACT = 8
CYCLE_MS = 10
LOOP_DELAY_S = 2e-3 * CYCLE_MS  # one cycle to the wire, one in the PLC


IN_A_TERMINAL = """
import os, signal, sys
signal.signal(signal.SIGHUP, signal.SIG_DFL)
os.setsid()
os.open(sys.argv[1], os.O_RDWR)  # of a session's leader: its terminal
os.execv(sys.argv[2], sys.argv[2:])
"""


@pytest.fixture(scope="module")
def terminal() -> Iterator[tuple[int, int]]:
    """A terminal: the end of whoever looks at it, and that of the programs in it."""
    ours, theirs = os.openpty()
    yield ours, theirs
    for one in (ours, theirs):
        try:
            os.close(one)
        except OSError:
            continue


@pytest.fixture(scope="module")
def service(
    tmp_path_factory: pytest.TempPathFactory, terminal: tuple[int, int]
) -> Iterator[ServiceRun]:
    """One service for all that it survives; who needs it running after an end asks ``again``."""
    run_as = (sys.executable, "-c", IN_A_TERMINAL, os.ttyname(terminal[1]))
    folder = tmp_path_factory.mktemp("service")
    run = ServiceRun(folder, cycle_ms=CYCLE_MS, run_as=run_as)
    yield run
    run.close()


@pytest.fixture
def fast(tmp_path: Path) -> Iterator[ServiceRun]:
    """Another one, in which the follower was probed before."""
    (tmp_path / "learned").mkdir()
    other = tmp_path / "learned" / "euclid_swrap_follower.json"
    other.write_text(known_response("swrap_follower"))
    run = ServiceRun(tmp_path, cycle_ms=CYCLE_MS)
    yield run
    run.close()


@pytest.fixture
def again(service: ServiceRun) -> ServiceRun:
    """The same, started anew where the test before has ended it."""
    if service.has_ended():
        service.start_again()
    return service


def test_it_starts_in_fault_with_zero_on_the_wire(service: ServiceRun) -> None:
    assert service.status()["state"] == "FAULT"
    words = service.tell_plc("words")
    assert words[3] == words[8] == 0
    assert words[4] == words[9] == 0xFFFF


def test_the_service_manager_hears_of_readiness_and_of_completed_ticks(
    service: ServiceRun,
) -> None:
    heard: list[bytes] = []
    until(
        "three watchdog notes",
        lambda: bool(heard.extend(service.notifications()) or heard.count(b"WATCHDOG=1") > 2),
    )
    assert b"READY=1" in heard


def test_the_watchdog_goes_hungry_when_the_control_process_hangs(service: ServiceRun) -> None:
    control = service.status()["control_pid"]
    os.kill(control, signal.SIGSTOP)
    try:
        service.notifications()
        pause(0.6)
        assert service.notifications() == []
    finally:
        os.kill(control, signal.SIGCONT)
    until("the service sees the PLC", lambda: service.status()["comm"] == "OK")


def test_who_looks_through_the_door_sees_every_tick_and_the_facts(service: ServiceRun) -> None:
    heard: list[DoorMessage] = []
    with contextlib.closing(DoorClient(service.runtime_dir / "door.sock")) as door:

        def is_told() -> bool:
            heard.extend(filter(None, [door.receive()]))
            facts = [one for one in heard if isinstance(one, Facts)]
            return bool(facts) and facts[-1].blocked.startswith("unwind: no measured response")

        until("the facts, with what blocks", is_told)
        (passed,) = [one for one in heard if isinstance(one, RingPassed)]
        facts = [one for one in heard if isinstance(one, Facts)][-1]
        with contextlib.closing(RingReader(passed.descriptor)) as ring:
            first = ring.signals.written_count()
            until("ticks", lambda: ring.signals.written_count() > first + 20)
            assert ring.writer_alive()
        assert facts.status.line == service.status()["line"]
        assert facts.status.facts is not None
        assert facts.status.facts.outputs[0].limit == 0.05


def test_arming_without_a_measured_response_is_refused_by_name(service: ServiceRun) -> None:
    with pytest.raises(RefusedError, match=r"^OFF, READY: blocked by unwind: no measured"):
        service.ask("arm")


def test_a_missing_permissive_is_named(service: ServiceRun) -> None:
    service.tell_plc(f"status {READY_STATUS & ~WEB_INTACT}")
    until("the missing permissive", lambda: service.status()["blocked_by"] == "WEB_INTACT=0")
    with pytest.raises(RefusedError, match=r"^OFF, READY: blocked by WEB_INTACT=0"):
        service.ask("arm")
    service.tell_plc(f"status {READY_STATUS}")
    until("the permissive is back", lambda: service.status()["blocked_by"] != "WEB_INTACT=0")


@pytest.mark.long  # quick, of a check that hangs: security/test_check_process.py
def test_a_bad_edit_changes_nothing_and_is_shown_with_its_place(service: ServiceRun) -> None:
    before = service.status()
    service.edit("settle_s: 6,", "settle_s: 9 apples,")
    until("the edit is refused", lambda: bool(service.status()["config_differs"]))
    after = service.status()
    assert after["config_hash"] == before["config_hash"]
    assert after["control_pid"] == before["control_pid"]
    (text,) = after["config_differs"]
    number = 1 + next(
        i for i, line in enumerate(service.site.read_text().splitlines()) if "apples" in line
    )
    assert text.startswith(f"{service.site}:{number}:")


@pytest.mark.long  # quick: security/test_evidence.py
def test_a_good_edit_is_applied_and_logged_with_both_values(service: ServiceRun) -> None:
    """And with it a response that was laid beside the site file, in the same check."""
    before = service.status()["config_hash"]
    (service.folder / "learned").mkdir(exist_ok=True)
    other = service.folder / "learned" / "euclid_swrap_follower.json"
    other.write_text(known_response("swrap_follower"))
    service.edit("settle_s: 9 apples,", "settle_s: 9,")
    said = ("actuators.unwind.blocks[0].settle_s: 6 s -> 9 s", "swrap_follower: response")
    until("both are applied", lambda: all(map(service.said, said)))
    assert service.status()["config_hash"] != before
    assert not service.status()["config_differs"]
    assert not service.said("CONTROL_DIED")


@pytest.mark.long  # in virtual time: supervisor/settings/test_desk.py, core/test_controller.py
def test_an_added_order_gets_its_columns_recorded(service: ServiceRun) -> None:
    service.edit("orders: [1, 2, 3, 4]", "orders: [1, 2, 3, 4, 5]")
    column = "unwind.unwind_5x.amplitude_m_s"
    until("the new order has columns", lambda: column in service.status().get("signals", {}))
    blocks = {block["name"]: block for block in service.status()["blocks"]}
    block, other = blocks["unwind_5x"], blocks["unwind_4x"]
    assert (block["actuator"], block["unit"], block["ripple_unit"]) == ("unwind", "m/s", "N")
    assert (block["limit"], block["settle_s"]) == (0.02, other["settle_s"])


def test_a_fixed_key_restarts_the_control_process_when_nothing_goes_out(
    service: ServiceRun,
) -> None:
    """A bypass that comes while the other one starts does not kill it."""
    before = service.status()["control_pid"]
    service.edit("    #deadline_ms: 3.0", "    deadline_ms: 3.5")
    until(
        "another control process",
        lambda: service.status().get("control_pid", 0) not in (0, before),
    )
    started = service.status()["control_pid"]
    for _ in range(5):
        service.ask("bypass")
    until("the service sees the PLC", lambda: service.status().get("comm") == "OK")
    until("BYPASS", lambda: service.status().get("state") == "BYPASS")
    assert service.status()["control_pid"] == started


@pytest.mark.long  # quick, in the middle of a probe: test_commissioning_kills.py
def test_a_killed_control_process_comes_back_idle(service: ServiceRun) -> None:
    before = service.status()["control_pid"]
    kill(before)
    until(
        "another control process",
        lambda: service.status().get("control_pid", 0) not in (0, before),
    )
    until("the service sees the PLC", lambda: service.status().get("comm") == "OK")
    assert service.status()["state"] == "FAULT"
    assert service.said("killed by SIGKILL")


@pytest.mark.long  # in virtual time: matrix/test_may.py, lockstep/test_operator.py
def test_a_shadow_run_leaves_fault_by_itself_and_transmits_zero(tmp_path: Path) -> None:
    run = ServiceRun(tmp_path, "--shadow")
    try:
        until("SHADOW", lambda: run.status().get("state") == "SHADOW")
        words = run.tell_plc("words")
        assert (words[1] & 0b1110, words[3], words[8]) == (0, 0, 0)
    finally:
        run.close()


def test_a_killed_recorder_is_replaced_and_the_run_goes_on_without_a_hole(
    service: ServiceRun,
) -> None:
    until("the recorder writes", lambda: service.status()["recorder"].get("rows", 0) > 0)
    folder = Path(service.status()["recorder"]["folder"])
    children = Path(f"/proc/{service.process.pid}/task/{service.process.pid}/children").read_text()
    (recorder,) = (
        int(pid)
        for pid in children.split()
        if b"telemetry.recorder" in Path(f"/proc/{pid}/cmdline").read_bytes()
    )
    kill(recorder)
    until("it goes on", (folder / "signals-0002.csv.gz").exists)
    until("another recorder", lambda: service.status()["recorder"].get("folder") == str(folder))
    assert service.status()["recorder"]["alive"]
    until("it has written", lambda: service.status()["recorder"].get("rows", 0) > 10)
    assert service.said(f"the recorder died (recorder {recorder}: killed by SIGKILL); another one")
    table = read_table(run_window(folder))
    assert set(np.diff(table.columns["tick"])) == {1.0}
    (said,) = [text for text in table.lost if "goes on" in text]
    assert said.endswith("no tick is lost")


def test_requests_without_sense_are_refused_and_the_service_lives(service: ServiceRun) -> None:
    for actuators in (5, None, [5], ["\ud800"], ["a\nb"]):
        with pytest.raises(RefusedError, match=r"a list of names|no actuator"):
            service.ask("probe", actuators=actuators)
    assert service.process.poll() is None


def known_response(actuator: str) -> str:
    """The PLC's own response: a gain and two ticks of delay, as if it had been probed."""
    points = [
        ResponsePoint(
            frequency_Hz=f,
            gain=-GAIN_N_PER_M_S,
            phase_rad=math.pi - math.tau * f * LOOP_DELAY_S,
            relative_error=0.01,
            coherence=1.0,
        )
        for f in (0.3, 0.6, 1.0, 1.5, 2.5)
    ]
    about = Provenance(actuator=actuator, signal="pullroll_tension_N")
    return Response(points=points, delay_s=LOOP_DELAY_S, provenance=about).to_json()


def probed(run: ServiceRun, actuator: str) -> list[dict[str, Any]]:
    """Probe, again when a pause of this machine made the guard end it, as an operator would."""
    for _ in range(2):
        with contextlib.suppress(RefusedError):
            return list(run.ask("probe", actuators=[actuator])["results"])
    return list(run.ask("probe", actuators=[actuator])["results"])


# quick, in virtual time: core/probe/test_probe.py, lockstep/test_operator.py; what was measured is
# kept, an edit waits: supervisor/test_probe_desk.py; the signal: security/test_evidence.py
@pytest.mark.long
def test_probe_arm_and_bypass_from_end_to_end(fast: ServiceRun) -> None:
    (result,) = probed(fast, "unwind")
    response = Response.from_json((fast.folder / "learned" / "euclid_unwind.json").read_text())
    for point in response.points:
        assert abs(point.gain / -GAIN_N_PER_M_S - 1.0) < 0.05
        expected_rad = math.pi - math.tau * point.frequency_Hz * LOOP_DELAY_S
        assert abs(math.remainder(point.phase_rad - expected_rad, math.tau)) < 0.1
    assert result["sign"] == -1
    assert response.provenance.radius_m == 0.16
    assert fast.status()["state"] == "BYPASS"
    assert fast.ask("arm")["state"] in ("ARMED", "ACTIVE")
    until("a correction on the wire", lambda: fast.tell_plc("words")[3] != 0)
    armed = fast.status()
    radii = ["radius_m: 0.15367", "radius_m: 0.154"]
    fast.edit(*(radii if radii[0] in fast.site.read_text() else reversed(radii)))
    until("the edit waits", lambda: "waits for bypass" in "".join(fast.status()["config_differs"]))
    assert fast.status()["config_hash"] == armed["config_hash"]
    os.kill(fast.process.pid, signal.SIGUSR1)
    until("zero on the wire", lambda: fast.tell_plc("words")[3] == 0)
    until(
        "the edit is applied",
        lambda: fast.status().get("config_hash") not in (None, armed["config_hash"]),
    )
    until("FAULT", lambda: fast.status().get("state") == "FAULT")


@pytest.mark.long  # quick: security/test_evidence.py, to its run
def test_stop_ends_everything_and_leaves_a_readable_run(fast: ServiceRun) -> None:
    control = fast.status()["control_pid"]
    until("it is recorded", lambda: fast.status()["recorder"].get("rows", 0) > 10)
    folder = Path(fast.status()["recorder"]["folder"])
    assert fast.ask("stop")["ok"]
    assert fast.process.wait(10) == 0
    assert not is_running(control)
    assert not (fast.runtime_dir / "control.sock").exists()
    run = read_run(folder)
    assert run.summary is not None
    assert run.summary.statistics.rows == len(run.columns["time_s"]) > 10
    assert {event["name"] for event in run.events} >= {"POWER_UP", "OPERATOR"}
    assert (folder / "site.yaml").read_text() == fast.site.read_text()


@pytest.mark.long  # quick, of SIGTERM: security/test_hand_of_service.py; of SIGHUP: below
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_that_ends_the_service_is_named_and_so_is_the_zero(
    again: ServiceRun, number: signal.Signals
) -> None:
    began = again.log.stat().st_size
    again.process.send_signal(number)
    assert again.process.wait(10) == 0
    words = again.tell_plc("words")
    assert words[3] == words[8] == 0
    said = again.log.read_bytes()[began:].decode()
    assert number.name in said
    assert "stopped; the correction reached zero" in said
    assert "bypassed, or a probe has ended" not in said


@pytest.mark.long  # in the middle of a probe: test_commissioning_kills.py
def test_a_killed_supervisor_takes_the_control_process_along_with_zero(again: ServiceRun) -> None:
    control = again.status()["control_pid"]
    kill(again.process.pid)
    until("the control process ends by itself", lambda: not is_running(control))
    words = again.tell_plc("words")
    assert words[3] == words[8] == 0


def test_a_terminal_that_closes_in_the_middle_of_a_probe_ends_the_service_with_a_fade(
    again: ServiceRun, terminal: tuple[int, int]
) -> None:
    """The last one: there is no terminal any more."""
    asked = Asked(again)
    status = again.status()
    control, folder = int(status["control_pid"]), Path(status["recorder"]["folder"])
    os.close(terminal[0])  # as a closed window or a lost ssh does: SIGHUP to all of its processes
    assert again.process.wait(20) == 0
    assert not is_running(control)
    assert on_the_wire(again) == [0, 0]
    assert asked.answer() != "done"
    assert again.said("SIGHUP (terminal closed): the correction fades to zero")
    assert again.said("stopped; the correction reached zero")
    assert read_run(folder).summary is not None, "the recorder wrote to the end"
