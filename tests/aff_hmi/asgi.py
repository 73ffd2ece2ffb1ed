"""Requests to an ASGI app without a network."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass

from starlette.types import ASGIApp, Message

from aff_hmi.gate import Gate, Rates
from aff_hmi.hub import Hub
from aff_hmi.pages import Pages
from aff_hmi.watch import Watch
from tests.doubles.virtual_clock import VirtualClock

HOST = "127.0.0.1:8480"
OWN_SOCKET = [("host", HOST), ("origin", f"http://{HOST}")]


@dataclass
class Answer:
    status: int
    headers: dict[str, str]
    body: str


def screen(tmp_path, clock: VirtualClock) -> tuple[Gate, Hub]:
    """Return the whole app behind its gate, and the hub in it."""
    hub = Hub(Watch(tmp_path / "door.sock", clock), clock)
    return Gate(Pages(hub, "en", clock).app(), [HOST], Rates(clock)), hub


def scope(
    path: str, headers: list[tuple[str, str]], kind: str, method: str, *, is_tls: bool = False
) -> dict[str, object]:
    """Return a request as uvicorn says it."""
    raw, _, query = path.partition("?")
    return {
        "type": kind,
        "asgi": {"version": "3.0"},
        "http_version": "1.1",
        "method": method,
        "scheme": ("ws" if kind == "websocket" else "http") + "s" * is_tls,
        "path": raw,
        "raw_path": raw.encode(),
        "root_path": "",
        "query_string": query.encode(),
        "headers": [(k.lower().encode(), v.encode("latin-1")) for k, v in headers],
        "client": ("127.0.0.1", 5000),
        "server": ("127.0.0.1", 8480),
        "subprotocols": [],
    }


def get(
    app: ASGIApp,
    path: str = "/",
    method: str = "GET",
    headers: list[tuple[str, str]] | None = None,
    *,
    is_tls: bool = False,
) -> Answer:
    """Return the answer to one request."""
    said: list[Message] = []

    async def receive() -> Message:
        return {"type": "http.request", "body": b"", "more_body": False}

    async def send(message: Message) -> None:
        said.append(message)

    given = [("host", HOST)] if headers is None else headers
    asyncio.run(app(scope(path, given, "http", method, is_tls=is_tls), receive, send))
    start, *rest = said
    found = {k.decode(): v.decode() for k, v in start["headers"]}
    body = b"".join(one.get("body", b"") for one in rest)
    return Answer(start["status"], found, body.decode())


def shake(
    app: ASGIApp, headers: list[tuple[str, str]], path: str = "/live", *, is_tls: bool = False
) -> list[Message]:
    """Return what a socket is told that leaves as soon as it is in."""
    said: list[Message] = []
    heard = iter([{"type": "websocket.connect"}, {"type": "websocket.disconnect", "code": 1000}])

    async def receive() -> Message:
        return next(heard)

    async def send(message: Message) -> None:
        said.append(message)

    asyncio.run(app(scope(path, headers, "websocket", "GET", is_tls=is_tls), receive, send))
    return said
