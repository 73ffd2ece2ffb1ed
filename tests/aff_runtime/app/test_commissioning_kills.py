"""Kills in the middle of a probe and of a try, between real processes: nothing of either is kept.

A signature that is killed at each of its steps is in ``card/test_book.py``, commissioner and
screen killed in one in ``commission/test_kills.py``; the plant's side in
``tests/lockstep/test_probe_kills.py``.
"""

from __future__ import annotations

import secrets
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from aff_runtime.app.hand.audit import verify
from aff_runtime.app.hand.may import Action, Place, Role
from aff_runtime.app.hand.messages import VALID_NS, Command, encode
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import AffError
from tests.aff_runtime.app.service_run import ServiceRun
from tests.processes import is_running, kill, until

pytestmark = [pytest.mark.wire, pytest.mark.timeout(240)]
OLD, NEW = "settle_s: 6,", "settle_s: 12,"
CORRECTIONS = (3, 8)


@pytest.fixture(scope="module")
def _run(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServiceRun]:
    run = ServiceRun(tmp_path_factory.mktemp("service"), "--state-dir", "/nowhere")
    yield run
    run.close()


@pytest.fixture
def service(_run: ServiceRun) -> ServiceRun:
    """A running service, started anew where the test before has killed it."""
    if _run.has_ended():
        _run.start_again()
    return _run


class Asked:
    """A probe that somebody waits for."""

    def __init__(self, service: ServiceRun) -> None:
        self.said: list[str] = []
        self._service = service
        self._thread = threading.Thread(target=self._ask)
        self._thread.start()
        until("the excitation is on the wire", lambda: any(on_the_wire(service)))

    def _ask(self) -> None:
        try:
            self._service.ask("probe", actuators=["unwind"])
            self.said.append("done")
        except (AffError, OSError) as error:
            self.said.append(str(error))

    def answer(self) -> str:
        self._thread.join(60.0)
        assert not self._thread.is_alive()
        return self.said[0]


def on_the_wire(service: ServiceRun) -> list[int]:
    words = service.tell_plc("words")
    return [words[place] for place in CORRECTIONS]


def learned(service: ServiceRun) -> list[str]:
    return sorted(path.name for path in (service.folder / "learned").glob("*.json"))


def test_a_control_process_killed_in_the_middle_of_a_probe_keeps_nothing(
    service: ServiceRun,
) -> None:
    asked = Asked(service)
    control = service.status()["control_pid"]
    kill(control)
    until("another one", lambda: service.status().get("control_pid", 0) not in (0, control))
    until("zero on the wire", lambda: not any(on_the_wire(service)))
    until("the service sees the PLC", lambda: service.status().get("comm") == "OK")
    assert asked.answer() != "done"
    assert service.status()["state"] == "FAULT"
    assert learned(service) == []


def tried(service: ServiceRun) -> str:
    """Begin a try; return the hash of the site file that stood before."""
    before = str(service.status()["site_hash"])
    changed = service.site.read_text().replace(OLD, NEW, 1)
    assert service.ask("settings", act="try", text=changed, seconds=600.0, why="hunting at 1x")
    assert service.status()["site_hash"] != before
    return before


# quick, in one process: app/supervisor/settings/test_desk.py
@pytest.mark.long
def test_a_control_process_that_dies_in_a_try_comes_back_on_the_former_settings(
    service: ServiceRun,
) -> None:
    before = tried(service)
    control = service.status()["control_pid"]
    kill(control)
    until("another one", lambda: service.status()["control_pid"] not in (0, control))
    until("signals", lambda: service.status().get("signals") is not None)
    assert service.status()["site_hash"] == before
    assert service.status()["trying"] == ""
    assert service.said("returned by the service: the control process died")


# quick: zero after this kill below, a try that writes nothing app/supervisor/settings/test_desk.py
@pytest.mark.long
def test_a_supervisor_killed_in_the_middle_of_a_try_starts_on_the_site_file(
    service: ServiceRun,
) -> None:
    text, before = service.site.read_bytes(), tried(service)
    control = service.status()["control_pid"]
    kill(service.process.pid)
    service.process.wait()
    until("the control process ends by itself", lambda: not is_running(control))
    assert on_the_wire(service) == [0, 0]
    assert service.site.read_bytes() == text
    service.start_again()
    assert service.status()["site_hash"] == before
    assert service.status()["trying"] == ""
    assert service.status()["state"] == "FAULT"


def test_a_supervisor_killed_in_the_middle_of_a_probe_takes_it_to_zero(
    service: ServiceRun,
) -> None:
    asked = Asked(service)
    control = service.status()["control_pid"]
    kill(service.process.pid)
    service.process.wait()
    until("the control process ends by itself", lambda: not is_running(control))
    assert on_the_wire(service) == [0, 0]
    assert asked.answer() != "done"
    assert learned(service) == []


SCREEN = """
import sys
from pathlib import Path
from aff_runtime.app.hand.client import HandClient
client = HandClient(Path(sys.argv[1]))
print("there", flush=True)
client._socket.send(sys.stdin.buffer.readline().strip())
sys.stdin.read()
"""


# at once in app/supervisor/hand/test_desk.py: who leaves before the answer disturbs nobody
@pytest.mark.long
def test_a_screen_killed_in_the_middle_of_its_probe_leaves_one_that_ends_by_itself(
    tmp_path: Path,
) -> None:
    (tmp_path / "state").mkdir()
    state = ("--state-dir", str(tmp_path / "state"))
    service = ServiceRun(tmp_path, "--hand", "commission", *state)
    try:
        until("it may be probed", lambda: service.status()["state"] == "FAULT")
        command = (sys.executable, "-c", SCREEN, str(service.runtime_dir / "hand.sock"))
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
        with subprocess.Popen(command, **pipes) as screen:
            assert screen.stdin is not None
            assert screen.stdout is not None
            assert screen.stdout.readline() == b"there\n"
            screen.stdin.write(encode(pressed(Action.PROBE, "FAULT")) + b"\n")
            screen.stdin.flush()
            until("the excitation is on the wire", lambda: any(on_the_wire(service)))
            kill(screen.pid)
        until("its end", lambda: service.status()["state"] != "ACTIVE")
        until("zero on the wire", lambda: not any(on_the_wire(service)))
        (audit,) = tmp_path.glob("state/audit/*/audit.jsonl")
        assert verify(audit).wrong == ""
        assert not service.said("Traceback")
    finally:
        service.close()


def pressed(action: Action, seen: str) -> Command:
    return Command(
        action=action,
        id=secrets.token_hex(16),
        account="anna",
        role=Role.COMMISSION,
        place=Place.PANEL,
        seen=seen,
        valid_until_ns=MonotonicClock().now_ns() + VALID_NS,
    )
