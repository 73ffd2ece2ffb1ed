"""Frames out, receipts in, and who is let go."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable
from pathlib import Path

import pytest

pytest.importorskip("starlette")

from starlette.websockets import WebSocket

from aff_hmi import frames
from aff_hmi.hub import MAX_IN_FLIGHT, MAX_SOCKETS, Hub
from tests.aff_hmi.asgi import OWN_SOCKET, scope, screen
from tests.aff_hmi.moments import row, seen
from tests.doubles.virtual_clock import VirtualClock


class Browser:
    """One end of a socket that does what a test says."""

    def __init__(self, hub: Hub) -> None:
        self.to_server: asyncio.Queue[dict[str, object]] = asyncio.Queue()
        self.frames: list[dict[str, object]] = []
        self.closed: int | None = None
        self.has_room = asyncio.Event()
        self.has_room.set()
        self.is_there = True
        socket = WebSocket(
            scope("/live", OWN_SOCKET, "websocket", "GET"), self.to_server.get, self._take
        )
        self.to_server.put_nowait({"type": "websocket.connect"})
        self.task = asyncio.create_task(hub.serve(socket, "en"))

    async def _take(self, message) -> None:
        await self.has_room.wait()
        if not self.is_there:
            raise OSError
        if message["type"] == "websocket.send":
            self.frames.append(json.loads(message["text"]))
        elif message["type"] == "websocket.close":
            self.closed = message["code"]

    def say(self, text: str) -> None:
        self.to_server.put_nowait({"type": "websocket.receive", "text": text})

    def receipt(self, number: int, stamp_ms: float) -> None:
        self.say(json.dumps({"a": number, "t": stamp_ms}))


async def turn() -> None:
    for _ in range(10):
        await asyncio.sleep(0)


def played(tmp_path: Path, play: Callable) -> None:
    """Run a play with a hub; what is left over is ended."""

    async def whole() -> None:
        clock = VirtualClock(1)
        _, hub = screen(tmp_path, clock)
        browsers: list[Browser] = []

        async def visit() -> Browser:
            browsers.append(Browser(hub))
            await turn()
            return browsers[-1]

        try:
            await play(hub, clock, visit)
        finally:
            for browser in browsers:
                browser.task.cancel()
            await asyncio.gather(*(b.task for b in browsers), return_exceptions=True)

    asyncio.run(whole())


def test_a_frame_answers_the_newest_stamp_of_its_browser(tmp_path: Path) -> None:
    async def play(hub, clock, visit) -> None:
        browser = await visit()
        hub.make_frames(seen())
        await turn()
        assert browser.frames == []  # nothing before it has said that it is there
        browser.receipt(0, 111.5)
        await turn()
        hub.make_frames(seen())
        await turn()
        assert browser.frames[-1]["echo"] == 111.5
        browser.receipt(browser.frames[-1]["q"], 222.5)
        await turn()
        hub.make_frames(seen())
        await turn()
        assert browser.frames[-1]["echo"] == 222.5
        assert browser.frames[-1]["values"]["tension:unwind_tension_N"] == 88.0

    played(tmp_path, play)


def test_a_frame_has_the_time_of_the_gateway(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What a page says of when has one clock, that of alarms, events and versions."""
    monkeypatch.setattr("aff_hmi.hub.wall_time_s", lambda: 1.8e9 + 0.04)

    async def play(hub, clock, visit) -> None:
        browser = await visit()
        browser.receipt(0, 1.0)
        await turn()
        hub.make_frames(seen())
        await turn()
        assert browser.frames[-1]["utc_s"] == 1.8e9

    played(tmp_path, play)


def test_the_first_page_that_is_asked_for_has_the_line_already(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One that had not would begin anew with the first frame, under the hands of who logs in."""

    async def play(hub, clock, visit) -> None:
        monkeypatch.setattr(hub._watch, "seen", seen)
        running = asyncio.create_task(hub.run())
        await asyncio.sleep(0)  # its clock stands still: what is due later comes never
        assert [one.actuator for one in hub.layout.outputs] == ["unwind"]
        running.cancel()
        await asyncio.gather(running, return_exceptions=True)

    played(tmp_path, play)


def test_who_comes_gets_a_frame_at_once_and_a_quiet_screen_polls_less(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    polls: list[int] = []

    async def play(hub, clock, visit) -> None:
        monkeypatch.setattr(hub._watch, "seen", seen)
        monkeypatch.setattr(hub._watch, "poll", lambda: polls.append(0))
        running = asyncio.create_task(hub.run())
        await asyncio.sleep(0.05)
        assert polls == [0]  # the next is due in half a second, of a clock that stands still here
        browser = await visit()
        browser.receipt(0, 1.0)
        await asyncio.sleep(0.1)
        assert [one["echo"] for one in browser.frames] == [1.0]
        assert len(polls) == 2
        running.cancel()
        await asyncio.gather(running, return_exceptions=True)

    played(tmp_path, play)


def test_who_does_not_keep_up_gets_the_newest_and_no_queue(tmp_path: Path) -> None:
    async def play(hub, clock, visit) -> None:
        browser = await visit()
        browser.receipt(0, 1.0)
        await turn()
        for n in range(20):
            hub.make_frames(seen(row(unwind_tension_N=float(n))))
            await turn()
        assert len(browser.frames) == MAX_IN_FLIGHT
        browser.receipt(browser.frames[-1]["q"], 2.0)
        await turn()
        hub.make_frames(seen(row(unwind_tension_N=99.0)))
        await turn()
        assert len(browser.frames) == MAX_IN_FLIGHT + 1
        assert browser.frames[-1]["values"]["tension:unwind_tension_N"] == 99.0

    played(tmp_path, play)


def test_who_has_no_room_holds_up_nobody_and_gets_the_newest_later(tmp_path: Path) -> None:
    async def play(hub, clock, visit) -> None:
        full, other = await visit(), await visit()
        for browser in (full, other):
            browser.receipt(0, 1.0)
        await turn()
        full.has_room.clear()
        hub.make_frames(seen(row(unwind_tension_N=1.0)))
        assert (len(full.frames), len(other.frames)) == (0, 1)
        assert (hub.counts.sent, hub.counts.skipped) == (1, 1)
        full.has_room.set()
        await turn()
        hub.make_frames(seen(row(unwind_tension_N=2.0)))
        assert [one["values"]["tension:unwind_tension_N"] for one in full.frames] == [2.0]

    played(tmp_path, play)


def test_who_has_gone_is_let_go_with_the_next_frame(tmp_path: Path) -> None:
    async def play(hub, clock, visit) -> None:
        gone, other = await visit(), await visit()
        for browser in (gone, other):
            browser.receipt(0, 1.0)
        await turn()
        gone.is_there = False
        hub.make_frames(seen())
        await turn()
        assert len(hub._viewers) == len(other.frames) == 1

    played(tmp_path, play)


def test_who_says_nothing_for_long_is_let_go(tmp_path: Path) -> None:
    async def play(hub, clock, visit) -> None:
        browser = await visit()
        clock.advance_ns(11_000_000_000)
        hub.make_frames(seen())
        await turn()
        assert browser.closed == 1008
        assert not hub._viewers

    played(tmp_path, play)


BAD = [
    "",
    "x",
    "{}",
    "[]",
    '{"a":-1,"t":1}',
    '{"a":1,"t":"1"}',
    '{"a":true,"t":1}',
    '{"a":1,"t":NaN}',
]
BAD += ['{"a":1,"t":1e999}', '{"do":"arm"}', '{"a":1,"t":' + "1" * 300 + "}", "[" * 200]


@pytest.mark.parametrize("text", BAD)
def test_what_is_no_receipt_ends_the_socket(tmp_path: Path, text: str) -> None:
    assert frames.said_by(text) is None

    async def play(hub, clock, visit) -> None:
        browser, other = await visit(), await visit()
        browser.say(text)
        await turn()
        assert browser.closed == 1008
        assert other.closed is None

    played(tmp_path, play)


def test_too_many_receipts_end_the_socket(tmp_path: Path) -> None:
    async def play(hub, clock, visit) -> None:
        browser = await visit()
        for n in range(25):
            browser.receipt(n, 1.0)
        await turn()
        await turn()
        await turn()
        assert browser.closed == 1008

    played(tmp_path, play)


def test_sockets_are_bounded(tmp_path: Path) -> None:
    async def play(hub, clock, visit) -> None:
        browsers = [await visit() for _ in range(MAX_SOCKETS + 1)]
        assert browsers[-1].closed == 1013
        assert [b.closed for b in browsers[:-1]] == [None] * MAX_SOCKETS

    played(tmp_path, play)


def test_a_frame_is_small_and_has_no_nan(tmp_path: Path) -> None:
    async def play(hub, clock, visit) -> None:
        browser = await visit()
        browser.receipt(0, 1.0)
        await turn()
        hub.make_frames(seen(row(unwind_tension_N=float("nan"), age_s=float("inf"))))
        await turn()
        text = json.dumps(browser.frames[-1], allow_nan=False)
        assert len(text) < 4000

    played(tmp_path, play)
