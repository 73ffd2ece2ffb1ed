"""A screen's end of ``commission.sock``: one request, one answer, and the connection ends."""

from __future__ import annotations

import asyncio
from pathlib import Path

from aff_runtime.app.commission.link.answers import Answer, decode
from aff_runtime.app.commission.link.messages import (
    MAX_TOLD_BYTES,
    PACKET_BYTES,
    Refusal,
    Request,
    Why,
    encode,
)
from aff_runtime.app.link.packet_client import connected
from aff_runtime.base.errors import AffError

NOBODY = "no commissioner answers ({error}); start it with `aff-runtime commission`"
PATIENCE_S = 20.0  # for a whole answer


async def ask(path: Path, asked: Request, patience_s: float = PATIENCE_S) -> Answer:
    """Return the answer to a request; the refusal ``SILENT`` where none comes."""
    try:
        return decode(asked.do, await exchanged(path, encode(asked), patience_s))
    except (AffError, OSError, ValueError, TimeoutError):
        return Refusal(why=Why.SILENT)


async def exchanged(path: Path, line: bytes, patience_s: float = PATIENCE_S) -> bytes:
    """Return what is answered to a line.

    Raises
    ------
    AffError
        No commissioner of ours is there.
    OSError, ValueError, TimeoutError
        It does not answer to the end, in time, with as much as an answer may hold.
    """
    end = connected(path, NOBODY)
    loop = asyncio.get_running_loop()
    try:
        async with asyncio.timeout(patience_s):
            for at in range(0, len(line), PACKET_BYTES):
                await loop.sock_sendall(end, line[at : at + PACKET_BYTES])
            parts, size = [], 0
            while part := await loop.sock_recv(end, 1 << 16):
                parts.append(part)
                size += len(part)
                if size > MAX_TOLD_BYTES:
                    raise ValueError(f"more than {MAX_TOLD_BYTES} bytes are answered")
        return b"".join(parts)
    finally:
        end.close()
