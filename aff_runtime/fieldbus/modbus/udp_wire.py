"""Modbus over UDP: one whole frame in one datagram; what is no whole frame counts as lost."""

from __future__ import annotations

import contextlib
import os
import select
import socket
from typing import Final

from aff_runtime.fieldbus.modbus.byte_stream import CLOSED, Connecting
from aff_runtime.fieldbus.modbus.frames import frame_length
from aff_runtime.fieldbus.modbus.tcp_wire import resolved

_MORE_THAN_A_FRAME: Final = 512  # a frame has 260 bytes at most; a longer datagram is cut here
_SELECT_LIMIT: Final = 1024
_MOST_WAITING: Final = 64


class UdpWire:
    """``ByteStream`` over UDP datagrams.

    The socket is connected: the kernel takes datagrams from the server's address and port alone,
    and reports a port on which nobody listens. A connection attempt is a new socket with a new
    port of its own, so a reply to an earlier one finds nobody. Nothing proves that the server is
    there until it has answered.

    Parameters
    ----------
    host, port : the server; a name is resolved here, once.

    Raises
    ------
    WireError
        When the name cannot be resolved.
    """

    lossy = True

    def __init__(self, host: str, port: int) -> None:
        self._kind, self._address = resolved(host, port, socket.SOCK_DGRAM)
        self._where = f"{host}:{port}/udp"
        self._socket: socket.socket | None = None
        self._datagram = bytearray(_MORE_THAN_A_FRAME)
        self.why_closed = ""

    def start_connect(self) -> bool:
        """Open a socket for this server; False when the system refuses it."""
        self.close(abort=True)
        try:
            fresh = socket.socket(*self._kind)
        except OSError as error:
            return self._failed(error)
        self._socket = fresh
        try:
            fresh.setblocking(False)
            fresh.connect(self._address)
            # a loopback port nobody listens on can be our own
            usable = fresh.fileno() < _SELECT_LIMIT and fresh.getsockname() != self._address
        except OSError as error:
            self.close(abort=True)
            return self._failed(error)
        if not usable:
            self.close(abort=True)
        self.why_closed = "" if usable else f"{self._where}: no usable socket"
        return usable

    def connecting(self) -> Connecting:
        """Return UP: a socket that is open is connected."""
        return Connecting.UP if self._socket is not None else Connecting.FAILED

    def send(self, frame: bytes) -> bool:
        """Send one datagram; False when the system did not take it."""
        if self._socket is None:
            return False
        try:
            return self._socket.send(frame) == len(frame)
        except OSError as error:
            return self._failed(error)

    def receive(self, into: memoryview, wait_ns: int) -> int:
        """Wait at most ``wait_ns`` for one datagram; the bytes of a whole frame, else 0 or -1."""
        current = self._socket
        if current is None:
            return CLOSED
        try:
            if wait_ns > 0 and not select.select((current,), (), (), wait_ns * 1e-9)[0]:
                return 0
            count = current.recv_into(self._datagram)
            for _ in range(_MOST_WAITING):
                if wait_ns > 0 or frame_length(self._datagram, count) == count:
                    break
                count = current.recv_into(self._datagram)  # junk hides none that waits behind it
        except BlockingIOError:
            return 0
        except OSError as error:
            self._failed(error)
            return CLOSED
        if frame_length(self._datagram, count) != count or count > len(into):
            return 0
        into[:count] = self._datagram[:count]
        return count

    def close(self, *, abort: bool) -> None:
        """Close the socket; what was sent cannot be taken back."""
        del abort
        current, self._socket = self._socket, None
        if current is not None:
            with contextlib.suppress(OSError):
                current.close()

    def _failed(self, error: OSError) -> bool:
        self.why_closed = f"{self._where}: {os.strerror(error.errno or 0)}"
        return False
