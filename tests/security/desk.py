"""A request desk on a real unix socket, served by hand: no threads, no waiting."""

from __future__ import annotations

import contextlib
import json
import os
import selectors
import signal
import socket
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from aff_runtime.app.link.answers import Done
from aff_runtime.app.link.request_socket import Asked, Caller, RequestSocket
from aff_runtime.app.supervisor.request_desk import RequestDesk

STATUS_BYTES = 20_000


class Desk:
    """The desk with a stand-in for the service behind it.

    ``status`` and ``bypass`` are answered at once, the other verbs when the test says so.

    Attributes
    ----------
    path : of the socket.
    asked : every request that reached the service.
    waiting : those without an answer.
    """

    def __init__(self, folder: Path) -> None:
        self.path = folder / "rt" / "control.sock"
        self.requests = RequestSocket(self.path)
        self._selector = selectors.DefaultSelector()
        self._desk = RequestDesk(self.requests, self._selector, self._do, self._forget)
        self.asked: list[Asked] = []
        self.waiting: list[Asked] = []
        self.gone: list[Caller] = []
        self._clients: list[socket.socket] = []

    def _do(self, asked: Asked) -> None:
        self.asked.append(asked)
        if asked.request.do == "status":
            asked.answer(Done(message="x" * STATUS_BYTES))
        elif asked.request.do == "bypass":
            asked.answer(Done())
        else:
            self.waiting.append(asked)

    def _forget(self, caller: Caller) -> None:
        self.gone.append(caller)

    def serve(self, rounds: int = 1) -> None:
        """Serve until nothing happens any more, ``rounds`` at most."""
        for _ in range(rounds):
            happened = self._selector.select(0.0)
            for key, events in happened:
                assert self._desk.serve(key, events)
            self._desk.look_after()
            if not happened:
                return

    def serve_all(self) -> None:
        """Serve until nothing happens any more."""
        self.serve(100_000)

    def connect(self) -> socket.socket:
        """Return a caller's end; the desk has taken it."""
        client = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self._clients.append(client)
        client.connect(str(self.path))
        client.setblocking(False)
        self.serve_all()
        return client

    def answers(self, client: socket.socket) -> Iterator[dict[str, Any]]:
        """Yield what came back so far, serving in between."""
        heard = b""
        while True:
            self.serve_all()
            try:
                chunk = client.recv(1 << 20)
            except (BlockingIOError, ConnectionResetError):
                break
            if not chunk:
                break
            heard += chunk
        *lines, rest = heard.split(b"\n")
        assert not rest
        for line in lines:
            yield json.loads(line)

    def close(self) -> None:
        """End it, and the callers' ends."""
        for client in self._clients:
            client.close()
        self._desk.close()
        self._selector.close()


def ended(client: socket.socket) -> bool:
    """Return whether the desk has hung up; reads what is left."""
    with contextlib.suppress(BlockingIOError):
        while True:
            try:
                if not client.recv(1 << 20):
                    return True
            except ConnectionResetError:
                return True
    return False


@contextlib.contextmanager
def answering(path: Path, answer: dict[str, Any], become: int | None = None) -> Iterator[None]:
    """Give every request at ``path`` one answer, in a process of its own, of another user even."""
    ready, up = os.pipe()
    child = os.fork()
    if child == 0:
        _answer_for_ever(path, json.dumps(answer).encode() + b"\n", up, become)
    os.close(up)
    try:
        assert os.read(ready, 1) == b"x"
        yield
    finally:
        os.close(ready)
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        path.unlink()


def _answer_for_ever(path: Path, answer: bytes, up: int, become: int | None) -> None:
    try:
        server = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        server.bind(str(path))
        if become is not None:
            os.setuid(become)
        server.listen(4)  # the kernel keeps who we are now
        os.write(up, b"x")
        while True:
            connection, _ = server.accept()
            while connection.recv(4096):
                connection.sendall(answer)
            connection.close()
    finally:
        os._exit(0)
