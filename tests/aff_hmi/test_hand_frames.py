"""What a socket shows of its own session: it follows every change, and is nobody else's."""

from __future__ import annotations

import asyncio
import json
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("starlette")

from starlette.types import Message

from aff_runtime.base.signals import State
from tests.aff_hmi.asgi import OWN_SOCKET, scope, screen
from tests.aff_hmi.moments import seen
from tests.aff_hmi.pressed import Browser, Pressed, quick
from tests.doubles.virtual_clock import VirtualClock


class Socket:
    """A browser's socket that answers every frame."""

    def __init__(self, app: Any, cookie: str = "") -> None:
        self._heard: asyncio.Queue[Message] = asyncio.Queue()
        self._told: asyncio.Queue[Message] = asyncio.Queue()
        headers = [*OWN_SOCKET, *([("cookie", cookie)] if cookie else [])]
        self._heard.put_nowait({"type": "websocket.connect"})
        made = scope("/live?lang=en", headers, "websocket", "GET")
        self._task = asyncio.ensure_future(app(made, self._heard.get, self._told.put))

    async def begin(self) -> None:
        assert (await self._told.get())["type"] == "websocket.accept"
        self.answer(0)
        await asyncio.sleep(0.01)

    def answer(self, number: int) -> None:
        said = json.dumps({"a": number, "t": 1.0})
        self._heard.put_nowait({"type": "websocket.receive", "text": said})

    async def frame(self) -> dict[str, Any]:
        async with asyncio.timeout(20.0):
            message = await self._told.get()
        found: dict[str, Any] = json.loads(message["text"])
        self.answer(found["q"])
        await asyncio.sleep(0.01)
        return found

    async def end(self) -> None:
        self._heard.put_nowait({"type": "websocket.disconnect", "code": 1000})
        await self._task


def test_each_socket_shows_its_own_session_as_it_is_now(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    quick(monkeypatch)
    at = Pressed(tmp_path)
    anna, bert = at.browser("anna"), at.browser("bert")
    anna.take()

    async def play() -> list[dict[str, Any]]:
        found = []
        sockets = [Socket(at.gate, one.cookie) for one in (anna, bert, Browser(at, "127.0.0.1"))]
        for socket in sockets:
            await socket.begin()
        at.show(State.READY)
        found += [await socket.frame() for socket in sockets]
        at.hand.sessions.end(anna.cookie.partition("=")[2])
        at.show(State.ACTIVE)
        found += [await socket.frame() for socket in sockets]
        for socket in sockets:
            await socket.end()
        return found

    frames = asyncio.run(play())
    own = [one["own"] for one in frames]
    assert [one["account"] for one in own] == ["anna", "bert", "", "", "bert", ""]
    assert [one["has_hand"] for one in own] == [True] + [False] * 5
    assert [one["hand_of"] for one in own] == ["anna"] * 3 + [""] * 3
    assert {action: own[0]["why"][action] for action in ("bypass", "arm")} == {
        "bypass": [],
        "arm": [],
    }
    assert own[1]["why"]["bypass"] == []
    assert own[1]["why"]["arm"] == ["anna has the hand"]
    assert "this account may not probe; the role commission is needed" in own[0]["why"]["probe"]
    assert own[2]["why"]["bypass"] == []  # at the panel it needs no login
    assert own[2]["why"]["arm"][0] == "log in first"
    assert own[4]["why"]["arm"] == ["it is armed already"]
    assert {one["state"] for one in frames[3:]} == {"ACTIVE"}


def test_a_button_says_the_first_reasons_and_counts_the_others_which_the_state_lists(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    quick(monkeypatch)
    at = Pressed(tmp_path)
    anna = at.browser("anna")

    async def play() -> dict[str, Any]:
        socket = Socket(at.gate, anna.cookie)
        await socket.begin()
        at.show(State.OFF, "LINE_RUN=0", tuple(f"unwind: unknown {i}" for i in range(5)))
        found = await socket.frame()
        await socket.end()
        return found

    frame = asyncio.run(play())
    why = frame["own"]["why"]["arm"]
    assert why[:2] == ["take the hand first", "blocked by LINE_RUN=0: the line does not run"]
    assert why[-1] == f"{1 + 1 + 5 - (len(why) - 1)} more reasons, see State"
    assert [one["why"] for one in frame["also"]] == [f"unwind: unknown {i}" for i in range(5)]


def test_a_screen_for_looking_only_shows_no_session(tmp_path: Path) -> None:
    app, hub = screen(tmp_path, VirtualClock(1))

    async def play() -> dict[str, Any]:
        socket = Socket(app)
        await socket.begin()
        hub.make_frames(seen())
        found = await socket.frame()
        await socket.end()
        return found

    assert "own" not in asyncio.run(play())
