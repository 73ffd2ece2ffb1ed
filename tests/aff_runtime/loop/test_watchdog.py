from __future__ import annotations

import os
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from aff_runtime.loop.watchdog import ServiceNotifier


@pytest.fixture
def manager(tmp_path: Path) -> Iterator[socket.socket]:
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as listener:
        listener.bind(str(tmp_path / "notify"))
        listener.setblocking(False)
        yield listener


def heard(listener: socket.socket) -> list[bytes]:
    words = []
    while True:
        try:
            words.append(listener.recv(256))
        except BlockingIOError:
            return words


@pytest.mark.wire
def test_ready_once_then_a_sign_of_life_every_few_completed_ticks(manager: socket.socket) -> None:
    notifier = ServiceNotifier({"NOTIFY_SOCKET": manager.getsockname()}, every_ticks=4)
    notifier.tick_done(first_exchange_ok=False)
    assert heard(manager) == []
    for _ in range(8):
        notifier.tick_done(first_exchange_ok=True)
    notifier.stopping()
    assert heard(manager) == [b"READY=1", b"WATCHDOG=1", b"WATCHDOG=1", b"STOPPING=1"]
    notifier.close()


@pytest.mark.wire
def test_an_abstract_address_is_understood() -> None:
    name = f"aff-test-{os.getpid()}"
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as listener:
        listener.bind("\0" + name)
        listener.setblocking(False)
        notifier = ServiceNotifier({"NOTIFY_SOCKET": "@" + name})
        notifier.stopping()
        assert heard(listener) == [b"STOPPING=1"]
        notifier.close()


@pytest.mark.wire
def test_a_watchdog_meant_for_another_process_is_not_fed(manager: socket.socket) -> None:
    environment = {"NOTIFY_SOCKET": manager.getsockname(), "WATCHDOG_PID": "1"}
    notifier = ServiceNotifier(environment, every_ticks=1)
    notifier.tick_done(first_exchange_ok=True)
    assert heard(manager) == [b"READY=1"]
    notifier.close()


def test_without_a_manager_nothing_is_opened_or_raised() -> None:
    notifier = ServiceNotifier({})
    notifier.tick_done(first_exchange_ok=True)
    notifier.stopping()
    assert notifier._socket is None
    notifier.close()


@pytest.mark.wire
def test_a_manager_that_went_away_or_does_not_read_never_blocks_or_raises(tmp_path: Path) -> None:
    path = tmp_path / "notify"
    notifier = ServiceNotifier({"NOTIFY_SOCKET": str(path)}, every_ticks=1)
    notifier.tick_done(first_exchange_ok=True)
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as deaf:
        deaf.bind(str(path))
        for _ in range(2000):
            notifier.tick_done(first_exchange_ok=True)
        deaf.setblocking(False)
        assert 0 < len(heard(deaf)) < 2000
    notifier.close()
