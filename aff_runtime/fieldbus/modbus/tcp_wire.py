"""One non-blocking TCP connection: connect, send, wait no longer than told, receive."""

from __future__ import annotations

import contextlib
import errno
import os
import select
import socket
import struct
from typing import Final

from aff_runtime.base.errors import WireError
from aff_runtime.fieldbus.modbus.byte_stream import CLOSED, Connecting

_NS_PER_MS: Final = 1_000_000
_SELECT_LIMIT: Final = 1024
_RESET_ON_CLOSE: Final = struct.pack("ii", 1, 0)


Kind = tuple[socket.AddressFamily, socket.SocketKind, int]
"""Family, type and protocol of a socket."""
Address = tuple[str | int, ...] | tuple[int, bytes]


def resolved(host: str, port: int, of: socket.SocketKind) -> tuple[Kind, Address]:
    """Return the socket that reaches a server, and its address; a name is resolved once, here.

    Raises
    ------
    WireError
        When the name cannot be resolved.
    """
    try:
        found = socket.getaddrinfo(host, port, type=of)
    except (OSError, UnicodeError) as error:
        raise WireError(
            f"{host}:{port} cannot be resolved ({error}); write its IP address or check DNS"
        ) from error
    family, kind, protocol, _, address = found[0]
    return (family, kind, protocol), address


class TcpWire:
    """``ByteStream`` over a TCP socket.

    TCP_QUICKACK is re-armed after each send and receive: without it a server that sends its
    reply in two segments with Nagle on waits for our delayed acknowledgement every cycle.

    Parameters
    ----------
    host, port : the server; a name is resolved here, once.

    Raises
    ------
    WireError
        When the name cannot be resolved.
    """

    lossy = False

    def __init__(self, host: str, port: int) -> None:
        self._kind, self._address = resolved(host, port, socket.SOCK_STREAM)
        self._where = f"{host}:{port}"
        self.why_closed = ""
        self._socket: socket.socket | None = None
        self._poll = select.poll()

    def start_connect(self) -> bool:
        """Begin a connection attempt; False when it failed at once."""
        self.close(abort=True)
        try:
            fresh = socket.socket(*self._kind)
        except OSError as error:
            self._failed(error.errno or 0)
            return False
        self._socket = fresh
        number = 0
        try:
            fresh.setblocking(False)
            fresh.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            number = fresh.connect_ex(self._address)
            started = number in (0, errno.EINPROGRESS)
        except OSError as error:
            started, number = False, error.errno or 0
        if not started or fresh.fileno() >= _SELECT_LIMIT:
            self._failed(number)
            self.close(abort=True)
            return False
        self._poll = select.poll()
        self._poll.register(fresh.fileno(), select.POLLIN)
        return True

    def connecting(self) -> Connecting:
        """Return the state of the attempt, without waiting."""
        current = self._socket
        if current is None:
            return Connecting.FAILED
        try:
            _, writable, _ = select.select((), (current,), (), 0.0)
            if not writable:
                return Connecting.PENDING
            number = current.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
            if number != 0:
                return self._failed(number)
            # a loopback port nobody listens on can be joined to itself
            if current.getsockname() == current.getpeername():
                return self._failed(errno.ECONNREFUSED)
            current.setsockopt(socket.IPPROTO_TCP, socket.TCP_QUICKACK, 1)
        except OSError as error:
            return self._failed(error.errno or 0)
        self.why_closed = ""
        return Connecting.UP

    def _failed(self, number: int) -> Connecting:
        self.why_closed = f"{self._where}: {os.strerror(number)}"
        return Connecting.FAILED

    def detach(self) -> socket.socket | None:
        """Give the connected socket away; None when there is none."""
        current, self._socket = self._socket, None
        return current

    def adopt(self, current: socket.socket) -> None:
        """Take a socket back, to close it."""
        self._socket = current

    def send(self, frame: bytes) -> bool:
        """Hand over the whole frame; False when the connection did not take it."""
        current = self._socket
        if current is None:
            return False
        try:
            taken = current.send(frame)
            current.setsockopt(socket.IPPROTO_TCP, socket.TCP_QUICKACK, 1)
        except OSError:
            return False
        return taken == len(frame)

    def receive(self, into: memoryview, wait_ns: int) -> int:
        """Wait at most ``wait_ns`` and read once; bytes read, 0 for none yet, -1 for closed.

        A wait of a millisecond or more is cut to whole milliseconds, the unit of ``poll``, so
        that it never ends late; the caller asks again for the rest.
        """
        current = self._socket
        if current is None:
            return CLOSED
        try:
            if wait_ns > 0 and not self._readable(current, wait_ns):
                return 0
            count = current.recv_into(into)
            if count == 0:
                return CLOSED
            current.setsockopt(socket.IPPROTO_TCP, socket.TCP_QUICKACK, 1)
        except BlockingIOError:
            return 0
        except OSError:
            return CLOSED
        return count

    def close(self, *, abort: bool) -> None:
        """Close; ``abort`` drops unsent and unacknowledged bytes instead of delivering them.

        A plain close would let the kernel deliver an old command long after, when the cable is
        back.
        """
        current, self._socket = self._socket, None
        if current is None:
            return
        with contextlib.suppress(OSError):
            if abort:
                current.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, _RESET_ON_CLOSE)
        with contextlib.suppress(OSError):
            current.close()

    def _readable(self, current: socket.socket, wait_ns: int) -> bool:
        if wait_ns >= _NS_PER_MS:
            return bool(self._poll.poll(wait_ns // _NS_PER_MS))
        return bool(select.select((current,), (), (), wait_ns * 1e-9)[0])
