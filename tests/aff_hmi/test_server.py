"""The web server under those who come and say nothing, or half of it."""

from __future__ import annotations

import asyncio
import contextlib
import json
import threading
from pathlib import Path

import pytest

pytest.importorskip("starlette")

from aff_hmi import admission, server
from aff_hmi.entrance import MAX_CONNECTIONS
from aff_hmi.hub import Hub
from aff_hmi.see.events import newest
from aff_hmi.watch import Watch
from aff_runtime.base.clock import MonotonicClock
from tests.aff_hmi.pressed import Pressed
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


@pytest.mark.parametrize("first", ["HEAD / HTTP/1.1", "GET /static/nothing HTTP/1.1"])
@pytest.mark.parametrize("more", [b"G", b"GET /metrics HTTP/1.1\r\nHost: x\r\n"])
def test_who_begins_another_request_and_never_ends_it_loses_his_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, first: str, more: bytes
) -> None:
    monkeypatch.setattr(server, "HEADER_PATIENCE_S", 0.3)

    async def play() -> None:
        watch = Watch(tmp_path / "door.sock", MonotonicClock())
        async with served(watch) as (port, _):
            reader, writer = await asyncio.open_connection("127.0.0.1", port)
            length = "Content-Length: 9\r\n" if first.startswith("GET") else ""
            writer.write(f"{first}\r\nHost: 127.0.0.1:{port}\r\n{length}\r\n".encode())
            await reader.readuntil(b"\r\n\r\n")
            writer.write(more)
            async with asyncio.timeout(10.0):  # a place held for ever fails here
                await reader.read()
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


async def pressed_bypass(port: int) -> str:
    """Bypass as the panel does without a login; return the status line of the answer."""
    said = json.dumps({"action": "bypass", "id": "b" * 32, "frame": 0, "seen": ""}).encode()
    heads = (
        f"POST /act HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nOrigin: http://127.0.0.1:{port}\r\n"
        f"Content-Type: application/json\r\nContent-Length: {len(said)}\r\n"
        "Connection: close\r\n\r\n"
    )
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    writer.write(heads.encode() + said)
    answer = (await reader.read()).decode()
    writer.close()
    return answer.partition("\r\n")[0]


def test_who_asks_for_history_and_goes_again_and_again_does_not_hold_up_a_bypass(
    keeping: Pressed, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(admission, "is_near", lambda address: address == "127.0.0.1")
    kept, go_on = keeping.kept, threading.Event()
    assert kept is not None

    async def play() -> None:
        watch = Watch(tmp_path / "door.sock", MonotonicClock())
        async with served(watch, kept, keeping.hand) as (port, hub):
            kept.store.put(lambda c: go_on.wait())
            for _ in range(MAX_CONNECTIONS + 16):
                _, writer = await asyncio.open_connection(
                    "127.0.0.1", port, local_addr=("127.0.0.2", 0)
                )
                head = f"GET /data/events HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n"
                writer.write(head.encode())
                await asyncio.sleep(0.005)
                writer.close()
            await frames(hub, 1)
            try:
                assert await pressed_bypass(port) == "HTTP/1.1 200 OK"
                kept.person("bypass: done", "anna")
                kept.journal._keep()
            finally:
                go_on.set()

    asyncio.run(play())
    assert keeping.service.commands[0].action == "bypass"
    assert kept.store.lost_count == 0
    assert kept.store.now(newest) > 0
