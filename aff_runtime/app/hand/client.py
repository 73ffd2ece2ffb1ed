"""The screen's end of the hand: says what was pressed, hears what became of it."""

from __future__ import annotations

from pathlib import Path

from aff_runtime.app.hand.messages import (
    MAX_PACKET_BYTES,
    HandMessageError,
    Said,
    Told,
    encode,
    read_told,
)
from aff_runtime.app.link.packet_client import connected
from aff_runtime.base.errors import WireError

NOBODY = "no service hears this screen ({error}); start it with --hand, or name its --hand-socket"


class HandClient:
    """A connection to the hand of a service; never blocks.

    Raises
    ------
    WireError
        When nobody listens there, or does not let this user in.
    RefusedError
        When folder or listener belong to somebody whose service this cannot be.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._socket = connected(path, NOBODY)

    def say(self, message: Said) -> None:
        """Say one thing.

        Raises
        ------
        WireError
            When the service has hung up, or does not listen now.
        """
        try:
            self._socket.send(encode(message))
        except OSError as error:
            raise WireError(f"{self._path}: {error.strerror or error}") from None

    def receive(self) -> Told | None:
        """Return the next message, None while there is none.

        Raises
        ------
        WireError
            When the service has hung up, or says what this release does not understand.
        """
        try:
            packet = self._socket.recv(2 * MAX_PACKET_BYTES)
        except BlockingIOError:
            return None
        except OSError as error:
            raise WireError(f"{self._path}: {error.strerror or error}") from None
        if not packet:
            raise WireError(f"{self._path}: the service has hung up")
        try:
            return read_told(packet)
        except HandMessageError as error:
            raise WireError(f"{self._path}: {error}") from None

    def fileno(self) -> int:
        """Return the descriptor, for an event loop."""
        return self._socket.fileno()

    def close(self) -> None:
        """Leave."""
        self._socket.close()
