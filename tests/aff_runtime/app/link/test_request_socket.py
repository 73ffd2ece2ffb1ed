"""Who may talk to the service, and what happens to those who babble."""

from __future__ import annotations

import json
import socket
import stat
from pathlib import Path

import pytest

from aff_runtime.app.link.request_client import ServiceClient
from aff_runtime.app.link.request_socket import (
    MAX_CALLERS,
    MAX_REQUEST_BYTES,
    Caller,
    RequestSocket,
    is_allowed_uid,
)
from aff_runtime.base.errors import RefusedError, WireError


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


def test_an_open_directory_is_closed_when_the_service_takes_it(tmp_path: Path) -> None:
    (tmp_path / "run").mkdir(mode=0o777)
    server = RequestSocket(tmp_path / "run" / "control.sock")
    assert stat.S_IMODE((tmp_path / "run").stat().st_mode) == 0o700
    server.close()


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
        assert caller.requests() == []
        caller_socket.sendall(b'tus"}\n')
        assert caller.requests() == [{"do": "status"}]
        caller.reply({"ok": True})
        assert json.loads(caller_socket.recv(100)) == {"ok": True}
    server.close()


@pytest.mark.parametrize(
    "text", [b"arm\n", b"[1]\n", b"[" * 4000 + b"\n", b"x" * MAX_REQUEST_BYTES + b"y"]
)
def test_a_caller_that_babbles_is_dropped(tmp_path: Path, text: bytes) -> None:
    path = tmp_path / "run" / "control.sock"
    server = RequestSocket(path)
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as caller_socket:
        caller_socket.connect(str(path))
        caller = accept(server)
        caller_socket.sendall(text)
        answers = [caller.requests(), caller.requests()]
        assert None in answers
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
    (tmp_path / "run" / name).mkdir(parents=True)
    with pytest.raises(RefusedError, match=rf"{name}: .*name another --runtime-dir"):
        RequestSocket(tmp_path / "run" / "control.sock")


def test_a_name_too_long_for_a_socket_is_refused_in_words(tmp_path: Path) -> None:
    with pytest.raises(RefusedError, match=r"too long.*name another --runtime-dir"):
        RequestSocket(tmp_path / ("d" * 120) / "control.sock")


def test_a_client_without_a_service_says_how_to_start_one(tmp_path: Path) -> None:
    with pytest.raises(WireError, match="aff-runtime run"):
        ServiceClient(tmp_path / "control.sock")
