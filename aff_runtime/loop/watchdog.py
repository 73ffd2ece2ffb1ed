"""Notices to systemd: ready, alive, stopping; none where it gave no socket."""

from __future__ import annotations

import contextlib
import os
import socket
from collections.abc import Mapping


class ServiceNotifier:
    """Sends sd_notify datagrams; never blocks and never raises.

    Parameters
    ----------
    environment : where ``NOTIFY_SOCKET`` is looked up (a leading @ is the abstract namespace).
    every_ticks : completed ticks between two ``WATCHDOG=1``.
    """

    def __init__(self, environment: Mapping[str, str], every_ticks: int = 20) -> None:
        self._every_ticks = every_ticks
        self._ticks = 0
        self._is_ready = False
        self._socket: socket.socket | None = None
        address = environment.get("NOTIFY_SOCKET", "")
        own_pid = str(os.getpid())
        self._feeds = environment.get("WATCHDOG_PID", own_pid) == own_pid
        if not address:
            return
        self._address = "\0" + address[1:] if address.startswith("@") else address
        self._socket = socket.socket(
            socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_CLOEXEC | socket.SOCK_NONBLOCK
        )

    def tick_done(self, first_exchange_ok: bool) -> None:
        """Count a completed tick; send READY=1 once the wire has worked, WATCHDOG=1 in turn."""
        if self._socket is None:
            return
        if first_exchange_ok and not self._is_ready:
            self._is_ready = True
            self._send(b"READY=1")
        self._ticks += 1
        if self._feeds and self._ticks >= self._every_ticks:
            self._ticks = 0
            self._send(b"WATCHDOG=1")

    def stopping(self) -> None:
        """Send that the service is on its way down."""
        self._send(b"STOPPING=1")

    def close(self) -> None:
        """Release the socket."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def _send(self, message: bytes) -> None:
        if self._socket is not None:
            with contextlib.suppress(OSError):
                self._socket.sendto(message, self._address)
