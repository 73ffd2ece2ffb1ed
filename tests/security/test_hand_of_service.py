"""A running service with a hand: it gives what ``aff-runtime`` gives, and no more."""

from __future__ import annotations

import contextlib
import os
import secrets
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from aff_runtime.app.hand.audit import verify
from aff_runtime.app.hand.client import HandClient
from aff_runtime.app.hand.may import Action, Code, Place, Role
from aff_runtime.app.hand.messages import VALID_NS, Answer, Command, Welcome
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import RefusedError
from tests.aff_runtime.app.service_run import ServiceRun
from tests.processes import until

pytestmark = pytest.mark.wire


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServiceRun]:
    folder = tmp_path_factory.mktemp("hand")
    state = folder / "state"
    state.mkdir()
    run = ServiceRun(folder, "--hand", "operate", "--state-dir", str(state))
    yield run
    run.close()


def command(service: ServiceRun, action: Action, **more: object) -> Command:
    said = {
        "id": secrets.token_hex(16),
        "account": "anna",
        "role": Role.OPERATE,
        "place": Place.PANEL,
        "seen": service.status()["state"],
        "valid_until_ns": MonotonicClock().now_ns() + VALID_NS // 2,
    } | more
    return Command(action=action, **said)  # type: ignore[arg-type]


def answer(client: HandClient, said: Command) -> Answer:
    client.say(said)
    heard: list[object] = []

    def is_answered() -> bool:
        heard.append(client.receive())
        return isinstance(heard[-1], Answer)

    until("the service answers", is_answered)
    assert isinstance(heard[-1], Answer)
    return heard[-1]


def audit_of(service: ServiceRun) -> Path:
    (found,) = (service.folder / "state" / "audit").glob("*/audit.jsonl")
    return found


def test_it_arms_and_takes_back_as_the_console_does(service: ServiceRun) -> None:
    with contextlib.closing(HandClient(service.runtime_dir / "hand.sock")) as client:
        until("it says what may be", lambda: isinstance(client.receive(), Welcome))
        with pytest.raises(RefusedError) as by_console:  # no response was measured here
            service.ask("arm")
        service.ask("bypass")
        until("bypassed", lambda: service.status()["state"] == "BYPASS")
        found = answer(client, command(service, Action.ARM))
        assert not found.ok
        assert found.reason is not None
        assert found.reason.text == str(by_console.value).removeprefix("OFF, READY: ")
        assert answer(client, command(service, Action.BYPASS, seen="")).ok
        until("bypassed", lambda: service.status()["state"] == "BYPASS")
        late = answer(client, command(service, Action.ARM, valid_until_ns=1))
        assert late.reason is not None
        assert late.reason.code is Code.LATE
    path = audit_of(service)
    assert (verify(path).wrong, path.stat().st_mode & 0o777) == ("", 0o600)
    assert service.said(f"audit {late.audit} {verify(path).newest[:12]}")


KILLED = """
import sys, os, signal
from pathlib import Path
from aff_runtime.app.hand.client import HandClient
client = HandClient(Path(sys.argv[1]))
client._socket.send(sys.argv[2].encode())
os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.parametrize("said", ['{"say": "com', '{"say":"notice"}', "x"])
def test_a_screen_that_is_killed_in_the_middle_changes_nothing(
    service: ServiceRun, said: str
) -> None:
    before = service.status()
    path = service.runtime_dir / "hand.sock"
    subprocess.run([sys.executable, "-c", KILLED, str(path), said], check=False)
    tick = service.status()["signals"]["tick"]
    until("20 ticks", lambda: service.status()["signals"]["tick"] > tick + 20)
    after = service.status()
    for name in ("state", "config_hash", "control_pid"):
        assert after[name] == before[name]
    assert len(os.listdir(f"/proc/{service.process.pid}/fd")) < 60
    assert not service.said("Traceback")
