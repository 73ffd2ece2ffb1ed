"""Who may talk to the service, and how requests and answers pass."""

from __future__ import annotations

import json
import os
import socket
import stat
from pathlib import Path

import pytest

from aff_runtime.app.link.answers import Done
from aff_runtime.app.link.request_client import ServiceClient
from aff_runtime.app.link.request_socket import (
    MAX_CALLERS,
    Asked,
    Caller,
    RequestSocket,
    is_allowed_uid,
)
from aff_runtime.app.link.requests import Request, read_request
from aff_runtime.base.errors import RefusedError, WireError
from tests.aff_runtime.app.link.left_behind import put


def accept(server: RequestSocket) -> Caller:
    caller = server.accept()
    assert caller is not None
    return caller


def test_directory_and_socket_are_closed_to_other_users(tmp_path: Path) -> None:
    path = tmp_path / "run" / "control.sock"
    server = RequestSocket(path)
    assert stat.S_IMODE(path.parent.stat().st_mode) == 0o700
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    server.close()
    assert not path.exists()


def test_a_link_in_place_of_the_directory_is_refused(tmp_path: Path) -> None:
    (tmp_path / "else").mkdir()
    (tmp_path / "run").symlink_to(tmp_path / "else")
    with pytest.raises(RefusedError, match="not a directory"):
        RequestSocket(tmp_path / "run" / "control.sock")


@pytest.mark.parametrize(("uid", "own", "allowed"), [(7, 7, True), (0, 7, True), (8, 7, False)])
def test_only_the_own_user_and_root_may_command(uid: int, own: int, allowed: bool) -> None:
    assert is_allowed_uid(uid, own) is allowed


def test_a_second_service_at_the_same_place_is_refused(tmp_path: Path) -> None:
    server = RequestSocket(tmp_path / "run" / "control.sock")
    with pytest.raises(RefusedError, match="already runs"):
        RequestSocket(tmp_path / "run" / "control.sock")
    server.close()
    RequestSocket(tmp_path / "run" / "control.sock").close()


def test_a_request_and_its_answer_pass_as_lines(tmp_path: Path) -> None:
    path = tmp_path / "run" / "control.sock"
    server = RequestSocket(path)
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as caller_socket:
        caller_socket.connect(str(path))
        caller = accept(server)
        caller_socket.sendall(b'{"do": "sta')
        assert caller.read()
        assert caller.next_line() is None
        caller_socket.sendall(b'tus", "id": 7}\n')
        assert caller.read()
        line = caller.next_line()
        assert line is not None
        asked = Asked(caller, read_request(line))
        assert asked.request == Request(do="status", ident=7)
        assert caller.owed == 1
        told: list[object] = []
        asked.then = told.append
        asked.answer(Done())
        asked.answer(Done(ok=False))  # one request, one answer
        assert told == [Done()]
        assert json.loads(caller_socket.recv(100)) == {"ok": True, "id": 7}
        assert caller.owed == 0
    server.close()


def test_the_kernel_says_who_calls(tmp_path: Path) -> None:
    path = tmp_path / "run" / "control.sock"
    server = RequestSocket(path)
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as caller_socket:
        caller_socket.connect(str(path))
        peer = accept(server).peer
    login = int(Path("/proc/self/loginuid").read_text())
    assert (peer.uid, peer.pid, peer.login_uid) == (os.geteuid(), os.getpid(), login)
    server.close()


def test_silent_callers_cannot_shut_out_the_next_one(tmp_path: Path) -> None:
    path = tmp_path / "run" / "control.sock"
    server = RequestSocket(path)
    clients = [socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) for _ in range(MAX_CALLERS + 1)]
    taken = []
    for client in clients:
        assert server.surplus() is None
        client.connect(str(path))
        taken.append(accept(server))
        server.heard(taken[0])
    assert server.surplus() is taken[1]  # the first one has spoken since
    for client in clients:
        client.close()
    server.close()


@pytest.mark.parametrize("name", ["control.sock", "control.lock"])
def test_a_directory_in_place_of_socket_or_lock_is_refused_in_words(
    tmp_path: Path, name: str
) -> None:
    (tmp_path / "run").mkdir(mode=0o700)
    (tmp_path / "run" / name).mkdir()
    with pytest.raises(RefusedError, match=rf"{name}: .*name another --runtime-dir"):
        RequestSocket(tmp_path / "run" / "control.sock")


@pytest.mark.parametrize("kind", ["file", "link", "pipe"])
def test_what_is_no_socket_stays_where_it_is(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "run" / "control.sock"
    path.parent.mkdir(mode=0o700)
    before = put(kind, path)
    with pytest.raises(RefusedError, match=r"is no socket and stays; .*--runtime-dir"):
        RequestSocket(path)
    assert path.lstat() == before


def test_a_socket_that_was_left_over_is_replaced_and_one_of_others_stays(tmp_path: Path) -> None:
    path = tmp_path / "run" / "control.sock"
    path.parent.mkdir(mode=0o700)
    put("socket", path)
    server = RequestSocket(path)
    path.unlink()
    before = put("socket", path)  # of somebody who came after us
    server.close()
    assert path.lstat() == before


def test_a_name_too_long_for_a_socket_is_refused_in_words(tmp_path: Path) -> None:
    with pytest.raises(RefusedError, match=r"too long.*name another --runtime-dir"):
        RequestSocket(tmp_path / ("d" * 120) / "control.sock")


def test_a_client_without_a_service_says_how_to_start_one(tmp_path: Path) -> None:
    with pytest.raises(WireError, match="aff-runtime run"):
        ServiceClient(tmp_path / "control.sock")


def test_a_probe_may_be_asked_to_be_louder_by_yes_or_no_alone() -> None:
    assert read_request(b'{"do": "probe", "louder": true}\n').louder is True
    assert read_request(b'{"do": "probe"}\n').louder is False
    with pytest.raises(RefusedError, match="louder: true or false is needed, not 2"):
        read_request(b'{"do": "probe", "louder": 2}\n')
