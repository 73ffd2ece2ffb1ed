"""Browsers without a screen, and people with bad manners, as a process of its own.

``python -m benchmarks.screen.clients look|flood URL SECONDS [--clients 10]`` prints JSON.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import json
import os
from dataclasses import dataclass
from urllib.parse import urlsplit

from websockets.asyncio.client import ClientConnection, connect
from websockets.typing import Origin

from aff_runtime.base.clock import MonotonicClock

ASKED_PER_S, SOCKETS_PER_S, LOGINS_PER_S, DAWDLERS = 1000, 200, 5, 4
CLOCK = MonotonicClock()


def now_s() -> float:
    """Return monotonic time, s."""
    return CLOCK.now_ns() * 1e-9


@dataclass
class Seen:
    """What all browsers saw together."""

    clients: int = 0
    frames: int = 0
    bytes: int = 0
    seconds: float = 0.0


def opened(url: str) -> connect:
    """Return a socket as a browser of that page opens it."""
    place = urlsplit(url)
    origin = Origin(f"http://{place.netloc}")
    return connect(f"ws://{place.netloc}/live?lang=en", origin=origin)


async def look(url: str, seconds: float, seen: Seen) -> None:
    """Be one browser that answers every frame."""
    async with opened(url) as socket:
        end_s = now_s() + seconds
        await socket.send(json.dumps({"a": 0, "t": 1e3 * now_s()}))
        while now_s() < end_s:
            text = await socket.recv()
            seen.frames, seen.bytes = seen.frames + 1, seen.bytes + len(text)
            await socket.send(json.dumps({"a": json.loads(text)["q"], "t": 1e3 * now_s()}))


async def flood(url: str, seconds: float, seen: Seen) -> None:
    """Ask without end, open sockets from elsewhere, guess passwords, and read slowly."""
    place = urlsplit(url)
    host, port = place.hostname or "127.0.0.1", place.port or 80
    end_s = now_s() + seconds

    async def say(head: str, body: str = "") -> None:
        reader, writer = await asyncio.open_connection(host, port)
        try:
            writer.write(f"{head}\r\nHost: {place.netloc}\r\n\r\n{body}".encode())
            await asyncio.wait_for(reader.read(200), 1.0)
            seen.frames += 1
        finally:
            writer.close()

    async def every(rate_per_s: float, head: str, body: str = "") -> None:
        due_s = now_s()
        while now_s() < end_s:
            with contextlib.suppress(OSError, TimeoutError):
                await say(head, body)
            due_s = max(due_s + 1.0 / rate_per_s, now_s() - 0.1)
            await asyncio.sleep(max(0.0, due_s - now_s()))

    async def dawdle() -> None:
        socket: ClientConnection
        with contextlib.suppress(OSError, TimeoutError, Exception):
            async with opened(url) as socket:
                await socket.send(json.dumps({"a": 0, "t": 0}))
                await asyncio.sleep(max(0.0, end_s - now_s()))

    guess = json.dumps({"name": "anna", "password": "wrong, 90 N"})
    json_head = (
        f"POST /login HTTP/1.1\r\nOrigin: http://{place.netloc}\r\n"
        f"Content-Type: application/json\r\nContent-Length: {len(guess)}"
    )
    from_elsewhere = (
        "GET /live HTTP/1.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
        "Origin: http://somebody.else"
    )
    ask = "GET /static/icon.svg HTTP/1.1\r\nConnection: close"
    hands = 10  # one connection does not ask a thousand times a second
    await asyncio.gather(
        *(every(ASKED_PER_S / hands, ask) for _ in range(hands)),
        *(every(SOCKETS_PER_S / hands, from_elsewhere) for _ in range(hands)),
        every(LOGINS_PER_S, json_head, guess),
        *(dawdle() for _ in range(DAWDLERS)),
    )


async def run(kind: str, url: str, seconds: float, clients: int) -> Seen:
    """Do one of the two for a while."""
    seen = Seen(clients=clients)
    start_s = now_s()
    if kind == "flood":
        await flood(url, seconds, seen)
    else:
        await asyncio.gather(*(look(url, seconds, seen) for _ in range(clients)))
    seen.seconds = now_s() - start_s
    return seen


def beside_control() -> None:
    """Leave the processor of the control process, the last, to it."""
    allowed = sorted(os.sched_getaffinity(0))
    os.sched_setaffinity(0, allowed[:-1] or allowed)


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("kind", choices=("look", "flood"))
    parser.add_argument("url")
    parser.add_argument("seconds", type=float)
    parser.add_argument("--clients", type=int, default=10)
    given = parser.parse_args()
    beside_control()
    print(json.dumps(vars(asyncio.run(run(given.kind, given.url, given.seconds, given.clients)))))


if __name__ == "__main__":
    main()
