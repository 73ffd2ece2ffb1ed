"""The screen's web server on a real socket, in this process."""

from __future__ import annotations

import asyncio
import contextlib
import socket
import ssl
import subprocess
from collections.abc import AsyncIterator
from pathlib import Path

from aff_hmi.hand import Hand
from aff_hmi.hub import Hub
from aff_hmi.listening import listening
from aff_hmi.see.kept import Kept
from aff_hmi.server import Unhurried, config_of
from aff_hmi.watch import Watch
from aff_runtime.base.clock import MonotonicClock


def certificate(folder: Path) -> tuple[Path, Path]:
    """Return a certificate and its key, made as docs/screen.md says."""
    made = "req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 1 -subj /CN=aff"
    files = ["-keyout", str(folder / "key.pem"), "-out", str(folder / "cert.pem")]
    names = ["-addext", "subjectAltName=DNS:aff-line1"]
    subprocess.run(["openssl", *made.split(), *names, *files], check=True, capture_output=True)
    return folder / "cert.pem", folder / "key.pem"


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("", 0))
        return int(probe.getsockname()[1])


@contextlib.asynccontextmanager
async def served(
    watch: Watch,
    kept: Kept | None = None,
    hand: Hand | None = None,
    *,
    address: str = "127.0.0.1",
    tls: tuple[Path, Path] | None = None,
) -> AsyncIterator[tuple[int, Hub]]:
    """Serve the screen of a watch, with its history and its hand where there are such."""
    port = free_port()
    if hand is not None and kept is not None:
        hand.desk.told = kept.person
    hub = Hub(watch, MonotonicClock(), hand, kept)
    place = listening(f"{address}:{port}", ("aff-line1",), *(tls or (None, None)), None)
    server = Unhurried(config_of(place, hub, "en"), place)
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


async def asked(
    port: int, path: str, *, address: str = "127.0.0.1", host: str = "127.0.0.1", tls: bool = False
) -> tuple[str, dict[str, str], str]:
    """Return the status line, headers and body of one request over TCP."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    reader, writer = await asyncio.open_connection(address, port, ssl=context if tls else None)
    writer.write(
        f"GET {path} HTTP/1.1\r\nHost: {host}:{port}\r\nConnection: close\r\n\r\n".encode()
    )
    head, _, body = (await reader.read()).decode().partition("\r\n\r\n")
    writer.close()
    await writer.wait_closed()
    first, *lines = head.split("\r\n")
    return first, dict(line.lower().split(": ", 1) for line in lines), body
