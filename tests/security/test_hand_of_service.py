"""A running service with a hand: it gives what ``aff-runtime`` gives, and no more."""

from __future__ import annotations

import contextlib
import http.client
import json
import os
import re
import secrets
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

pytest.importorskip("starlette")

from aff_runtime.app.hand.accounts import Account, secret_of
from aff_runtime.app.hand.audit import verify
from aff_runtime.app.hand.client import HandClient
from aff_runtime.app.hand.may import Action, Code, Place, Role
from aff_runtime.app.hand.messages import PRESS_REFUSED, VALID_NS, Answer, Command, Welcome
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import RefusedError
from sim_plant.demo.wires import free_port
from tests.aff_runtime.app.service_run import ROOT, ServiceRun
from tests.processes import forked, kill, until

pytestmark = pytest.mark.wire
PASSWORD = "tension, 90 N"


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
        "valid_until_ns": MonotonicClock().now_ns() + VALID_NS,
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


def say_and_die(path: Path, said: str) -> None:
    """Send what is no whole message, and be killed."""
    HandClient(path)._socket.send(said.encode())
    kill(os.getpid())


@pytest.mark.parametrize("said", ['{"say": "com', '{"say":"notice"}', "x"])
def test_a_screen_that_is_killed_in_the_middle_changes_nothing(
    service: ServiceRun, said: str
) -> None:
    before = service.status()
    path = service.runtime_dir / "hand.sock"
    _, ended = os.waitpid(forked(lambda: say_and_die(path, said)), 0)
    assert ended == signal.SIGKILL
    tick = service.status()["signals"]["tick"]
    until("20 ticks", lambda: service.status()["signals"]["tick"] > tick + 20)
    after = service.status()
    for name in ("state", "config_hash", "control_pid"):
        assert after[name] == before[name]
    assert len(os.listdir(f"/proc/{service.process.pid}/fd")) < 60
    assert not service.said("Traceback")


class Browser:
    """Speaks HTTP to a screen of its own, as the page does."""

    def __init__(self, service: ServiceRun) -> None:
        accounts = service.folder / "accounts"
        line = Account(name="anna", role=Role.OPERATE, secret=secret_of(PASSWORD)).line
        accounts.write_text(line + "\n")
        accounts.chmod(0o600)
        self.port = free_port()
        self.process = subprocess.Popen(
            [
                *(sys.executable, "-m", "aff_hmi.main", "--listen", f"127.0.0.1:{self.port}"),
                *("--door", str(service.runtime_dir / "door.sock")),
                *("--hand-socket", str(service.runtime_dir / "hand.sock")),
                *("--accounts", str(accounts)),
            ],
            stdout=subprocess.PIPE,
            text=True,
            cwd=ROOT,
        )
        assert self.process.stdout is not None
        assert self.process.stdout.readline().startswith("look: ")
        self.cookie = self.token = ""

    def ask(self, method: str, path: str, said: object = None) -> tuple[int, str]:
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=20.0)
        headers = {
            "Origin": f"http://127.0.0.1:{self.port}",
            "Content-Type": "application/json",
            "X-Aff-Token": self.token,
            "Cookie": self.cookie,
        }
        body = None if said is None else json.dumps(said)
        connection.request(method, path, body, headers)
        answer = connection.getresponse()
        self.cookie = (answer.getheader("set-cookie") or self.cookie).partition(";")[0]
        text = answer.read().decode()
        connection.close()
        return answer.status, text

    def log_in(self) -> None:
        assert self.ask("POST", "/login", {"name": "anna", "password": PASSWORD})[0] == 200
        found = re.search(r'data-token="([^"]+)"', self.ask("GET", "/")[1])
        assert found is not None
        self.token = found[1]

    def press(self, action: str, seen: str = "") -> tuple[int, str]:
        said = {"action": action, "id": secrets.token_hex(16), "seen": seen, "frame": 0}
        return self.ask("POST", "/act", said)

    def close(self) -> None:
        self.process.kill()
        self.process.wait()
        assert self.process.stdout is not None
        self.process.stdout.close()


def test_a_press_in_a_browser_reaches_the_line_and_the_audit(service: ServiceRun) -> None:
    with contextlib.closing(Browser(service)) as browser:
        with contextlib.suppress(RefusedError):
            service.ask("arm")  # out of BYPASS, wherever it leads
        before = service.status()["state"]
        assert browser.press("arm", before)[0] == 401
        assert service.status()["state"] == before
        until("nobody is heard", lambda: browser.press("bypass")[0] == 200)
        until("bypassed", lambda: service.status()["state"] == "BYPASS")
        browser.log_in()
        until("the screen is heard", lambda: browser.press("bypass")[0] == 200)
        until("bypassed", lambda: service.status()["state"] == "BYPASS")
        status, text = browser.press("arm", "BYPASS")
        assert (status, json.loads(text)["code"]) == (409, Code.NO_HAND)
        assert browser.ask("POST", "/hand", {"do": "take", "of": ""})[0] == 200
        status, text = browser.press("arm", "BYPASS")
        assert (status, json.loads(text)["code"]) == (409, Code.GUARD)  # no response measured
    rows = [json.loads(line) for line in audit_of(service).read_text().splitlines()]
    assert "bypass" in [row["what"] for row in rows if row["account"] == "nobody"]
    assert [row["what"] for row in rows if row["account"] == "anna"][-5:] == [
        *("login", "bypass", PRESS_REFUSED, "hand taken", PRESS_REFUSED)
    ]
    assert [row["why"] for row in rows if row["what"] == PRESS_REFUSED][-2:] == [
        *("arm: no hand", "arm: guard")
    ]
    assert verify(audit_of(service)).wrong == ""


def test_a_signal_that_ends_the_service_is_named_and_so_is_the_zero(service: ServiceRun) -> None:
    """The last one: there is no service any more."""
    began = service.log.stat().st_size
    service.process.terminate()
    assert service.process.wait(10) == 0
    words = service.tell_plc("words")
    assert words[3] == words[8] == 0
    said = service.log.read_bytes()[began:].decode()
    assert "SIGTERM" in said
    assert "stopped; the correction reached zero" in said
    assert "bypassed, or a probe has ended" not in said
    assert verify(audit_of(service)).wrong == ""
