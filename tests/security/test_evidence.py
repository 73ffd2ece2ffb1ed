"""Who did what: the kernel's word in log, events and record, and no other taken for it."""

from __future__ import annotations

import errno
import json
import os
import re
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from aff_runtime.app.link import peer, request_client
from aff_runtime.app.link.peer import NOBODY_LOGGED_IN, Peer, author_of, peer_of
from aff_runtime.app.link.request_socket import Asked, Caller
from aff_runtime.app.link.requests import Request
from aff_runtime.app.supervisor import request_desk
from aff_runtime.base.errors import RefusedError
from tests import quick_yaml
from tests.aff_runtime.app.service_run import ServiceRun
from tests.doubles.run_reader import read_run
from tests.processes import until
from tests.security.desk import Desk

pytestmark = pytest.mark.processes

NAMES = {0: "root", 1000: "tech1", 999: "aff-runtime"}


@pytest.fixture
def people(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(peer, "user_name", lambda uid: NAMES.get(uid, "no name"))


@pytest.mark.parametrize(
    ("uid", "login", "told"),
    [
        (1000, 1000, "uid 1000 (tech1), pid 4711"),
        (0, 1000, "uid 1000 (tech1 via root), pid 4711"),
        (999, 1000, "uid 1000 (tech1 via aff-runtime), pid 4711"),
        (0, NOBODY_LOGGED_IN, "uid 0 (root, no login), pid 4711"),
        (0, None, "uid 0 (root, login not known), pid 4711"),
        (7, 7, "uid 7 (no name), pid 4711"),
    ],
)
@pytest.mark.usefixtures("people")
def test_a_command_names_the_person_behind_sudo(uid: int, login: int | None, told: str) -> None:
    assert str(Peer(uid=uid, pid=4711, login_uid=login)) == told


def test_what_a_caller_writes_into_its_environment_changes_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    ours, theirs = socket.socketpair(socket.AF_UNIX)
    before = str(peer_of(ours))
    for name in ("SUDO_USER", "SUDO_UID", "LOGNAME", "USER"):
        monkeypatch.setenv(name, "0")
    assert str(peer_of(ours)) == before
    ours.close()
    theirs.close()


def _gone(folder: Path) -> None:
    pass


def _of_somebody_else(folder: Path) -> None:
    if os.geteuid() != 0:
        pytest.skip("needs root to give a file away")
    folder.mkdir()
    (folder / "loginuid").write_text("1000")
    os.chown(folder, 65534, 65534)


def _no_number(folder: Path) -> None:
    folder.mkdir()
    (folder / "loginuid").write_text("tech1\n")


@pytest.mark.parametrize("spoil", [_gone, _of_somebody_else, _no_number])
def test_a_login_that_cannot_be_known_is_not_guessed(
    tmp_path: Path, spoil: Callable[[Path], None]
) -> None:
    ours, theirs = socket.socketpair(socket.AF_UNIX)
    spoil(tmp_path / str(os.getpid()))
    assert peer_of(ours, tmp_path).login_uid is None
    ours.close()
    theirs.close()


def test_a_login_that_the_kernel_knows_is_told(tmp_path: Path) -> None:
    ours, theirs = socket.socketpair(socket.AF_UNIX)
    folder = tmp_path / str(os.getpid())
    folder.mkdir()
    (folder / "loginuid").write_text("1000")
    assert peer_of(ours, tmp_path) == Peer(uid=os.geteuid(), pid=os.getpid(), login_uid=1000)
    ours.close()
    theirs.close()


def test_the_number_of_a_caller_who_has_ended_is_not_taken_for_him(tmp_path: Path) -> None:
    """Another process may have it by then, with the login of somebody who commanded nothing."""
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(str(tmp_path / "s"))
        listener.listen()
        program = "import socket, sys; socket.socket(socket.AF_UNIX).connect(sys.argv[1])"
        with subprocess.Popen([sys.executable, "-c", program, str(tmp_path / "s")]) as caller:
            caller.wait()
        ours, _ = listener.accept()
    with ours:
        try:
            ours.getsockopt(socket.SOL_SOCKET, 77, 4)
        except OSError as error:
            if error.errno == errno.ENOPROTOOPT:
                pytest.skip("this kernel has no SO_PEERPIDFD")
        folder = tmp_path / str(caller.pid)
        folder.mkdir()
        (folder / "loginuid").write_text("1000")
        found = peer_of(ours, tmp_path)
    assert (found.pid, found.login_uid) == (caller.pid, None)


@pytest.mark.usefixtures("people")
@pytest.mark.parametrize(
    ("uid", "login", "said"),
    [
        (0, 1000, "login 1000 (tech1)"),
        (0, 0, ""),
        (0, NOBODY_LOGGED_IN, ""),
        (0, None, ""),
        (999, 1000, ""),
    ],
)
def test_root_says_by_whose_login_it_commands_for_the_service_cannot_look(
    uid: int, login: int | None, said: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Under ProtectProc=invisible the processes of root are in no /proc of the service's."""
    monkeypatch.setattr(request_client, "user_name", lambda uid: NAMES[uid])
    us = Peer(uid=uid, pid=1, login_uid=login)
    monkeypatch.setattr(request_client, "own_process", lambda: us, raising=False)
    path = tmp_path / "control.sock"
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(str(path))
        listener.listen()
        client = request_client.ServiceClient(path)
        theirs, _ = listener.accept()
        with theirs:
            theirs.sendall(b'{"ok": true}\n')
            client.ask("bypass")
            client.close()
            assert json.loads(theirs.recv(4096)).get("by", "") == said


# --- on behalf of somebody ------------------------------------------------------------------


@pytest.mark.usefixtures("people")
@pytest.mark.parametrize(
    ("claim", "shown"),
    [
        ("shift leader", '"shift leader"'),
        ("x\nINFO OPERATOR: arm", r'"x\nINFO OPERATOR: arm"'),
        ("\x1b[2J\u202e", r'"\x1b[2J\u202e"'),
        ('a" as it says, uid 0 "', "\"a' as it says, uid 0 '\""),
    ],
)
def test_a_claim_stands_escaped_beside_the_kernels_word_and_never_in_its_place(
    claim: str, shown: str
) -> None:
    ours, theirs = socket.socketpair(socket.AF_UNIX)
    caller = Caller(ours, Peer(uid=999, pid=4711, login_uid=NOBODY_LOGGED_IN))
    who = Asked(caller, Request(do="arm", by=claim)).who
    assert who == f"uid 999 (aff-runtime, no login), pid 4711, on behalf of {shown} as it says"
    ours.close()
    theirs.close()


def test_only_a_service_of_ours_may_speak_for_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    desk = Desk(tmp_path)
    client = desk.connect()
    request = json.dumps({"do": "bypass", "by": "tech1", "id": 1}).encode() + b"\n"
    client.send(request)
    assert [answer["ok"] for answer in desk.answers(client)] == [True]
    monkeypatch.setattr(request_desk, "service_uids", frozenset)
    client.send(request)
    (refused,) = desk.answers(client)
    assert refused["message"] == "by: only a service of ours speaks for others"
    assert len(desk.asked) == 1
    desk.close()


# --- files ----------------------------------------------------------------------------------


def test_of_a_file_its_owner_and_its_time_are_told_and_no_more(tmp_path: Path) -> None:
    path = tmp_path / "site.yaml"
    path.write_text("version: 1\n")
    os.utime(path, (1767323045, 1767323045))
    uid = os.geteuid()
    told = rf"file of uid {uid} \(.+\), written 2026-01-02T03:04:05\+00:00"
    assert re.fullmatch(told, author_of(path))
    path.unlink()
    assert author_of(path) == "who wrote it is not known: No such file or directory"


# --- the whole service ----------------------------------------------------------------------


@pytest.fixture
def service(tmp_path: Path) -> Iterator[ServiceRun]:
    run = ServiceRun(tmp_path)
    yield run
    run.close()


@pytest.mark.wire
def test_every_command_and_every_edit_has_its_author_in_log_events_and_record(
    service: ServiceRun,
) -> None:
    me = re.escape(str(peer.own_process()))
    for words in (
        {"do": "shadow", "on": True},
        {"do": "shadow", "on": False, "by": "shift\nleader"},
        {"do": "forget"},
    ):
        service.ask(**words)
    with pytest.raises(RefusedError):
        service.ask("arm")
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as impatient:
        impatient.connect(str(service.runtime_dir / "control.sock"))
        impatient.send(b'{"do": "probe"}\n')
        until("the probe is told", lambda: service.said("OPERATOR: probe"))
    service.ask("bypass")
    service.edit("settle_s: 6,", "settle_s: 9,")
    until("the edit is applied", lambda: service.said("settle_s: 6 s -> 9 s"))
    os.kill(service.process.pid, 10)
    until("the signal is told", lambda: service.said("bypass by SIGUSR1; who sent it"))
    rows = service.status()["commands"]
    counted = {(row["action"], row["via"], row["result"]): row["count"] for row in rows}
    assert (
        counted.items()
        >= {
            ("shadow", "cli", "done"): 2,
            ("forget", "cli", "done"): 1,
            ("arm", "cli", "refused"): 1,
            ("bypass", "cli", "done"): 1,
            ("bypass", "signal", "done"): 1,
        }.items()
    )
    service.ask("stop")
    assert service.process.wait(15) == 0
    (folder,) = (service.folder / "runs").iterdir()
    run = read_run(folder)
    log = [line.split(" ", 3)[3] for line in service.log.read_text().splitlines()]
    events = [f"{event['name']}: {event['text']}" for event in run.events]
    expected = [
        f"OPERATOR: shadow on by {me}",
        rf'OPERATOR: shadow off by {me}, on behalf of "shift\\nleader" as it says',
        f"OPERATOR: forget by {me}",
        f"OPERATOR: bypass by {me}",
        f"OPERATOR: arm by {me}",
        f"OPERATOR: probe by {me}",
        rf"EDIT: {re.escape(str(service.site))}: file of uid {os.geteuid()} .*, written 20.*",
        f"OPERATOR: stop by {me}",
    ]
    for said in (log, events):
        for pattern in expected:
            assert any(re.fullmatch(pattern, line) for line in said), (pattern, said)
    about = quick_yaml.safe_load((folder / "run.yaml").read_text())
    assert re.fullmatch(rf"uid .*, pid {service.process.pid}", about["started_by"])
