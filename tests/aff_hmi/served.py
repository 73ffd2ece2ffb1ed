"""The screen's web server on a real socket, in this process."""

from __future__ import annotations

import asyncio
import contextlib
import socket
from collections.abc import AsyncIterator

import uvicorn

from aff_hmi.hand import Hand
from aff_hmi.hub import Hub
from aff_hmi.listening import listening
from aff_hmi.see.kept import Kept
from aff_hmi.server import config_of
from aff_hmi.watch import Watch
from aff_runtime.base.clock import MonotonicClock


@contextlib.asynccontextmanager
async def served(
    watch: Watch, kept: Kept | None = None, hand: Hand | None = None
) -> AsyncIterator[tuple[int, Hub]]:
    """Serve the screen of a watch, with its history and its hand where there are such."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    hub = Hub(watch, MonotonicClock(), hand, kept)
    place = listening(f"127.0.0.1:{port}", (), None, None, None)
    server = uvicorn.Server(config_of(place, hub, "en"))
    polling, serving = asyncio.create_task(hub.run()), asyncio.create_task(server.serve())
    try:
        while not server.started:
            await asyncio.sleep(0.01)
        yield port, hub
    finally:
        server.should_exit = True
        await serving
        polling.cancel()
        await asyncio.gather(polling, return_exceptions=True)
        watch.close()


async def asked(port: int, path: str) -> tuple[str, dict[str, str], str]:
    """Return the status line, headers and body of one request over TCP."""
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    writer.write(
        f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nConnection: close\r\n\r\n".encode()
    )
    head, _, body = (await reader.read()).decode().partition("\r\n\r\n")
    writer.close()
    await writer.wait_closed()
    first, *lines = head.split("\r\n")
    return first, dict(line.lower().split(": ", 1) for line in lines), body
