"""One browser that looks on: its socket, and the frames that it has not acknowledged yet."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

from starlette.websockets import WebSocket, WebSocketDisconnect


class Viewer:
    """One socket.

    Attributes
    ----------
    own : returns what is of its session alone, as JSON.
    topic : of its page, empty for none.
    in_flight : numbers of the frames that were sent to it and that it has not acknowledged.
    echo_ms : its newest stamp, said back to it; None until it was heard.
    listening : hears it; its end lets it go.
    """

    def __init__(
        self, socket: WebSocket, language: str, address: str, own: Callable[[], str], topic: str
    ) -> None:
        self._socket = socket
        self.language = language
        self.topic = topic
        self.address = address
        self.own = own
        self.in_flight: list[int] = []
        self.echo_ms: float | None = None
        self.heard_ns = 0
        self.listening: asyncio.Task[None] | None = None

    def send(self, text: str) -> bool:
        """Hand a text to the socket at once, or not at all; False where it takes none now.

        A socket with room takes it without waiting. One that has none would wait before it takes
        any of it: then nothing is sent, for the next frame is newer.
        """
        sending = self._socket.send_text(text)
        try:
            sending.send(None)
        except StopIteration:
            return True
        except (RuntimeError, WebSocketDisconnect):
            self.end()
            return False
        sending.close()
        return False

    def end(self) -> None:
        """Let it go."""
        if self.listening is not None:
            self.listening.cancel()

    def heard(self, number: int, stamp_ms: float, now_ns: int) -> None:
        """Take a receipt."""
        self.in_flight = [sent for sent in self.in_flight if sent > number]
        self.echo_ms, self.heard_ns = stamp_ms, now_ns
