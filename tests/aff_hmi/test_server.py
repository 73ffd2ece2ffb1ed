"""The web server under those who come and say nothing, or half of it."""

from __future__ import annotations

import asyncio
import contextlib
from pathlib import Path

import pytest

pytest.importorskip("starlette")

from aff_hmi import admission, server
from aff_hmi.hub import Hub
from aff_hmi.server import MAX_CONNECTIONS
from aff_hmi.watch import Watch
from aff_runtime.base.clock import MonotonicClock
from tests.aff_hmi.served import asked, served

pytestmark = pytest.mark.wire


async def frames(hub: Hub, count: int) -> None:
    """Wait for so many rounds of polling and making frames."""
    last = hub._number + count
    while hub._number < last:
        await asyncio.sleep(0.02)


async def crowd(port: int) -> list[tuple[asyncio.StreamReader, asyncio.StreamWriter]]:
    """Take every place there is."""
    return [await asyncio.open_connection("127.0.0.1", port) for _ in range(MAX_CONNECTIONS)]


@pytest.mark.parametrize("said", [b"", b"G", b"GET /metrics HTTP/1.1\r\nHost: x\r\n"])
def test_those_who_fill_every_place_are_let_go_and_the_line_is_followed_meanwhile(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, said: bytes
) -> None:
    monkeypatch.setattr(server, "HEADER_PATIENCE_S", 1.0)

    async def play() -> None:
        watch = Watch(tmp_path / "door.sock", MonotonicClock())
        async with served(watch) as (port, hub):
            flood = await crowd(port)
            for _, writer in flood:
                writer.write(said)
            await frames(hub, 3)
            for reader, _ in flood:  # each is let go, without a word of the line
                with contextlib.suppress(ConnectionResetError):
                    assert b"aff_" not in await reader.read()
            status, _, body = await asked(port, "/metrics")
            assert status == "HTTP/1.1 200 OK"
            assert "aff_control_up 0.0" in body
            for _, writer in flood:
                writer.close()

    asyncio.run(play())


def test_a_line_that_has_asked_once_is_not_taken_for_one_that_says_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(server, "HEADER_PATIENCE_S", 0.3)

    async def play() -> None:
        watch = Watch(tmp_path / "door.sock", MonotonicClock())
        async with served(watch) as (port, _):
            reader, writer = await asyncio.open_connection("127.0.0.1", port)
            for _ in range(2):
                writer.write(f"GET /metrics HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n".encode())
                head = await reader.readuntil(b"\r\n\r\n")
                assert head.startswith(b"HTTP/1.1 200 OK")
                length = int(head.lower().partition(b"content-length: ")[2].split(b"\r\n")[0])
                await reader.readexactly(length)
                await asyncio.sleep(0.5)  # longer than a first request may take
            writer.close()

    asyncio.run(play())


def test_one_too_many_is_told_to_come_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(server, "HEADER_PATIENCE_S", 60.0)

    async def play() -> None:
        watch = Watch(tmp_path / "door.sock", MonotonicClock())
        async with served(watch) as (port, hub):
            flood = await crowd(port)
            await frames(hub, 1)
            status, _, body = await asked(port, "/metrics")
            assert status.startswith("HTTP/1.1 503")
            assert "aff_" not in body
            for _, writer in flood:
                writer.close()
            await frames(hub, 2)
            status, _, _ = await asked(port, "/metrics")
            assert status == "HTTP/1.1 200 OK"

    asyncio.run(play())


def test_one_stranger_of_the_network_takes_half_of_the_places(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(server, "HEADER_PATIENCE_S", 60.0)
    monkeypatch.setattr(admission, "is_near", lambda address: False)

    async def play() -> None:
        watch = Watch(tmp_path / "door.sock", MonotonicClock())
        async with served(watch) as (port, hub):
            flood = await crowd(port)
            await frames(hub, 2)
            sent_away = [reader.at_eof() for reader, _ in flood]
            assert sent_away == [False] * (MAX_CONNECTIONS // 2) + [True] * (MAX_CONNECTIONS // 2)
            monkeypatch.setattr(admission, "is_near", lambda address: True)
            status, _, _ = await asked(port, "/metrics")
            assert status == "HTTP/1.1 200 OK"
            for _, writer in flood:
                writer.close()

    asyncio.run(play())
