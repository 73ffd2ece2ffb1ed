"""A screen's end of ``commission.sock``: one request, one answer, and the connection ends."""

from __future__ import annotations

import asyncio
import json
from pathlib import Path

from aff_runtime.app.commission.messages import MAX_TOLD_BYTES, Refusal, Told, Why
from aff_runtime.app.link.packet_client import connected
from aff_runtime.base.errors import AffError

NOBODY = "no commissioner answers ({error}); start it with `aff-runtime commission`"
PATIENCE_S = 20.0


async def ask(path: Path, said: Told, patience_s: float = PATIENCE_S) -> Told:
    """Return the answer to a request; a refusal that says so where none comes."""
    try:
        end = connected(path, NOBODY)
    except (AffError, OSError):
        return Refusal(why=Why.SILENT).told
    loop = asyncio.get_running_loop()
    try:
        async with asyncio.timeout(patience_s):
            await loop.sock_sendall(end, json.dumps(said).encode())
            parts, size = [], 0
            while part := await loop.sock_recv(end, 1 << 16):
                parts.append(part)
                size += len(part)
                if size > MAX_TOLD_BYTES:
                    raise ValueError
        found = json.loads(b"".join(parts))
        return found if isinstance(found, dict) else Refusal(why=Why.SILENT).told
    except (OSError, ValueError, RecursionError, TimeoutError):
        return Refusal(why=Why.SILENT).told
    finally:
        end.close()
