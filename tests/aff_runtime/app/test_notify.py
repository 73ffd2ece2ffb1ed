"""Datagrams to systemd's socket, file and abstract names."""

from __future__ import annotations

import socket
from contextlib import closing
from pathlib import Path

import pytest

from aff_runtime.app.notify import Notifier


@pytest.mark.parametrize("abstract", [False, True])
def test_a_state_arrives_at_the_named_socket(tmp_path: Path, abstract: bool) -> None:
    name = f"@aff-test-{tmp_path.name}-{tmp_path.parent.name}" if abstract else str(tmp_path / "n")
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as server:
        server.bind("\0" + name[1:] if abstract else name)
        with closing(Notifier({"NOTIFY_SOCKET": name})) as notifier:
            notifier.send(b"WATCHDOG=1")
        assert server.recv(100) == b"WATCHDOG=1"


@pytest.mark.parametrize("environment", [{"NOTIFY_SOCKET": "/nowhere/at/all"}, {}])
def test_a_socket_that_is_not_there_is_no_error(environment: dict[str, str]) -> None:
    with closing(Notifier(environment)) as notifier:
        notifier.send(b"READY=1")
