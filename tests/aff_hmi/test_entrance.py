"""Who comes to an address of a network, on real sockets: silent ones before TLS, and the panel."""

from __future__ import annotations

import asyncio
import contextlib
import socket
from pathlib import Path

import pytest

pytest.importorskip("starlette")

from aff_hmi import admission, entrance, listening, server
from aff_hmi.entrance import MAX_CONNECTIONS, MAX_TOLD
from aff_hmi.watch import Watch
from aff_runtime.base.clock import MonotonicClock
from tests.aff_hmi.pressed import Pressed
from tests.aff_hmi.served import asked, certificate, served
from tests.aff_hmi.test_server import pressed_bypass

pytestmark = pytest.mark.wire

PANEL, LINE, OTHER = "127.0.0.1", "127.0.0.2", "127.0.0.3"
Ends = tuple[asyncio.StreamReader, asyncio.StreamWriter]


@pytest.fixture(autouse=True)
def _only_one_address_is_loopback(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have the kernel's other addresses of loopback stand for a network."""
    for module in (admission, listening):
        monkeypatch.setattr(module, "is_near", lambda address: address == PANEL)


@pytest.fixture
def watch(tmp_path: Path) -> Watch:
    return Watch(tmp_path / "door.sock", MonotonicClock())


async def silent(port: int, count: int, *, of: str = LINE, at: str = LINE) -> list[Ends]:
    """Return connections that say nothing, once the screen has looked at them all."""
    ends = [await asyncio.open_connection(at, port, local_addr=(of, 0)) for _ in range(count)]
    await asyncio.sleep(0.3)
    return ends


def stay(ends: list[Ends]) -> int:
    return sum(not reader.at_eof() for reader, _ in ends)


@pytest.mark.parametrize("address", ["0.0.0.0", LINE])
def test_a_silent_stranger_before_tls_has_half_of_the_places_and_no_more(
    watch: Watch, tmp_path: Path, address: str
) -> None:
    async def play() -> None:
        async with served(watch, address=address, tls=certificate(tmp_path)) as (port, _):
            flood = await silent(port, 3 * MAX_CONNECTIONS)
            assert stay(flood) == MAX_CONNECTIONS // 2
            others = await silent(port, MAX_CONNECTIONS, of=OTHER)
            assert stay(flood) + stay(others) == 3 * MAX_CONNECTIONS // 4
            status, _, _ = await asked(port, "/metrics")  # the panel has its own
            assert status == "HTTP/1.1 200 OK"
            for _, writer in flood + others:
                writer.close()

    asyncio.run(play())


def test_who_does_not_agree_on_tls_is_let_go_and_makes_room(
    watch: Watch, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(entrance, "HANDSHAKE_S", 0.5)

    async def play() -> None:
        async with served(watch, address=LINE, tls=certificate(tmp_path)) as (port, _):
            flood = await silent(port, MAX_CONNECTIONS)
            for reader, _ in flood:
                with contextlib.suppress(ConnectionResetError):
                    assert await reader.read() == b""
            status, heads, _ = await asked(port, "/", address=LINE, host="aff-line1", tls=True)
            assert status == "HTTP/1.1 200 OK"
            assert "strict-transport-security" in heads
            for _, writer in flood:
                writer.close()

    asyncio.run(play())


def test_of_those_without_a_place_some_are_told_and_the_rest_goes(
    watch: Watch, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(server, "HEADER_PATIENCE_S", 60.0)

    async def play() -> None:
        async with served(watch) as (port, _):
            flood = await silent(port, 2 * MAX_CONNECTIONS, of=PANEL, at=PANEL)
            assert stay(flood) == MAX_CONNECTIONS + MAX_TOLD
            for _, writer in flood:
                writer.close()

    asyncio.run(play())


@pytest.mark.parametrize("address", ["0.0.0.0", LINE])
def test_the_panel_stays_beside_an_address_of_a_network_in_clear_and_may_what_it_may(
    keeping: Pressed, watch: Watch, tmp_path: Path, address: str
) -> None:
    async def play() -> None:
        tls, hand = certificate(tmp_path), keeping.hand
        async with served(watch, keeping.kept, hand, address=address, tls=tls) as (port, _):
            assert await pressed_bypass(port) == "HTTP/1.1 200 OK"
            for name in ("127.0.0.1", "localhost", "aff-line1"):
                status, heads, _ = await asked(port, "/", host=name)
                assert status == "HTTP/1.1 200 OK"
                assert "strict-transport-security" not in heads
            status, _, _ = await asked(port, "/", address=LINE, host="aff-line1", tls=True)
            assert status == "HTTP/1.1 200 OK"
            status = ""
            with contextlib.suppress(ConnectionResetError):
                status, _, _ = await asked(port, "/", address=LINE, host="aff-line1")
            assert status == ""  # a network hears nothing in clear

    asyncio.run(play())
    (command,) = keeping.service.commands
    assert (command.account, command.place) == ("nobody", "panel")


def test_without_a_descriptor_left_nobody_is_let_in_and_later_ones_are(
    watch: Watch, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(entrance, "RETRY_S", 0.1)
    real, left = socket.socket.accept, [True]

    def accept(listener: socket.socket) -> tuple[socket.socket, object]:
        if left and left.pop():
            raise OSError(24, "Too many open files")
        return real(listener)

    async def play() -> None:
        async with served(watch) as (port, _):
            monkeypatch.setattr(socket.socket, "accept", accept)
            status, _, _ = await asked(port, "/metrics")
            assert status == "HTTP/1.1 200 OK"
            assert not left

    asyncio.run(play())
