"""Tells systemd that we are ready and alive; silent where there is no systemd."""

from __future__ import annotations

import contextlib
import os
import socket
from collections.abc import Mapping


class Notifier:
    """Sends datagrams to ``$NOTIFY_SOCKET``.

    Parameters
    ----------
    environment : of the process; ``NOTIFY_SOCKET`` names the socket (``@`` begins an abstract
        name). Without it every call does nothing.
    """

    __slots__ = ("_address", "_socket")

    def __init__(self, environment: Mapping[str, str] | None = None) -> None:
        address = (os.environ if environment is None else environment).get("NOTIFY_SOCKET", "")
        self._address = "\0" + address[1:] if address.startswith("@") else address
        self._socket: socket.socket | None = None
        if address:
            self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
            self._socket.setblocking(False)

    def send(self, state: bytes) -> None:
        """Send ``READY=1``, ``WATCHDOG=1``, ``STOPPING=1`` or ``STATUS=...``; never raises."""
        if self._socket is not None:
            with contextlib.suppress(OSError):
                self._socket.sendto(state, self._address)

    def close(self) -> None:
        """Release the socket."""
        if self._socket is not None:
            self._socket.close()
