"""Listens at ``commission.sock``: one request a connection, of root, ourselves or the screen."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Awaitable, Callable
from pathlib import Path

from aff_runtime.app.commission.link.answers import Answer, encode
from aff_runtime.app.commission.link.messages import (
    MAX_TEXTS_BYTES,
    NAME,
    PACKET_BYTES,
    Refusal,
    Request,
    RequestError,
    Why,
    read_request,
)
from aff_runtime.app.link.peer import Peer, peer_of, uids_with
from aff_runtime.app.supervisor.packet_listener import SCREEN_USER, listening
from aff_runtime.base.socket_file import identity, remove_own

MOST = 16  # requests at a time
PATIENCE_S, LONGEST_S = 5.0, 900.0  # for a request to come or an answer to go; to work it out
ANOTHER = "name another folder with --dir"
Answering = Callable[[Request, Peer], Awaitable[Answer]]


class Listener:
    """Takes requests, ``MOST`` at a time; one beyond that waits in the kernel's queue.

    Parameters
    ----------
    folder : of the socket. ``is_private`` : it is for our own user alone.

    Raises
    ------
    RefusedError
        When no socket can be made there, or another commissioner listens at it.
    """

    def __init__(self, folder: Path, answer: Answering, *, is_private: bool) -> None:
        self._path = folder / NAME
        self._answer = answer
        self._socket = listening(self._path, 0o600 if is_private else 0o660, MOST, ANOTHER)
        self._made = identity(self._path)
        self._places = asyncio.Semaphore(MOST)
        self._tasks: set[asyncio.Task[None]] = set()

    async def run(self) -> None:
        """Listen for ever."""
        loop = asyncio.get_running_loop()
        while True:
            await self._places.acquire()
            end, _ = await loop.sock_accept(self._socket)
            task = asyncio.create_task(self._serve(end))
            self._tasks.add(task)
            task.add_done_callback(self._tasks.discard)

    def close(self) -> None:
        """Listen no more."""
        self._socket.close()
        remove_own(self._path, self._made)

    async def _serve(self, end: socket.socket) -> None:
        """Answer one request."""
        loop = asyncio.get_running_loop()
        try:
            end.setblocking(False)
            peer = peer_of(end)
            if peer.uid not in uids_with(SCREEN_USER):
                return
            async with asyncio.timeout(PATIENCE_S):
                line = await _line(end)
            try:
                async with asyncio.timeout(LONGEST_S):
                    answer = await self._answer(read_request(line), peer)
            except RequestError:
                answer = Refusal(why=Why.NO_SENSE)
            sent = encode(answer)
            async with asyncio.timeout(PATIENCE_S):
                for at in range(0, len(sent), PACKET_BYTES):
                    await loop.sock_sendall(end, sent[at : at + PACKET_BYTES])
        except (OSError, TimeoutError):
            return
        finally:
            end.close()
            self._places.release()


async def _line(end: socket.socket) -> bytes:
    """Return a request, of which one packet after another comes; what is too much is cut."""
    loop = asyncio.get_running_loop()
    parts, size = [], 0
    while size <= MAX_TEXTS_BYTES:
        part = await loop.sock_recv(end, PACKET_BYTES)
        parts.append(part)
        size += len(part)
        if len(part) < PACKET_BYTES:
            break
    return b"".join(parts)
