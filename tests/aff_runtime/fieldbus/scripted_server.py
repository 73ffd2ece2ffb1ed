"""A little Modbus TCP server in a thread whose every answer is a function of the test."""

from __future__ import annotations

import contextlib
import socket
import struct
import threading
from collections.abc import Callable

Respond = Callable[[socket.socket, bytes], None]


class ScriptedServer:
    """Hands each request to ``respond``; an exception there or a closed socket ends the client.

    ``requests`` and ``resets`` (clients that ended with RST) grow as they happen.
    """

    def __init__(self, respond: Respond, port: int = 0) -> None:
        self.respond = respond
        self.requests: list[bytes] = []
        self.resets = 0
        self._listener = socket.create_server(("127.0.0.1", port))
        self.port: int = self._listener.getsockname()[1]
        self._clients: list[socket.socket] = []
        self._threads: list[threading.Thread] = []
        self._stopping = False
        self._start(self._accept)

    def __enter__(self) -> ScriptedServer:
        return self

    def __exit__(self, *_error: object) -> None:
        self.stop()

    def stop(self) -> None:
        self._stopping = True
        with contextlib.suppress(OSError):
            self._listener.shutdown(socket.SHUT_RDWR)
        for client in self._clients:
            with contextlib.suppress(OSError):
                client.shutdown(socket.SHUT_RDWR)
        for thread in self._threads:
            thread.join(5.0)
        self._listener.close()

    def _start(self, work: Callable[..., None], *arguments: object) -> None:
        thread = threading.Thread(target=work, args=arguments, daemon=True)
        self._threads.append(thread)
        thread.start()

    def _accept(self) -> None:
        while not self._stopping:
            try:
                client, _ = self._listener.accept()
            except OSError:
                return
            self._clients.append(client)
            self._start(self._serve, client)

    def _serve(self, client: socket.socket) -> None:
        with client:
            try:
                while request := _read_frame(client):
                    self.requests.append(request)
                    self.respond(client, request)
            except ConnectionResetError:
                self.resets += 1
            except OSError:
                return


def reset(client: socket.socket) -> None:
    """Close with RST."""
    client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    client.close()


def _read_frame(client: socket.socket) -> bytes:
    head = _read(client, 6)
    return head + _read(client, int.from_bytes(head[4:6], "big")) if head else b""


def _read(client: socket.socket, count: int) -> bytes:
    got = b""
    while len(got) < count:
        more = client.recv(count - len(got))
        if not more:
            return b""
        got += more
    return got
