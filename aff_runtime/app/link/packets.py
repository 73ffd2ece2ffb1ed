"""The socketpair between supervisor and control process: one message per packet.

The kernel keeps packets apart, so neither side ever reassembles. The end of the stream means that
the other process is dead, however it died.
"""

from __future__ import annotations

import os
import socket
import struct

from aff_runtime.app.link.messages import Message, MessageError, decode, encode

MAX_PACKET_BYTES = 1 << 18
_DESCRIPTOR = struct.Struct("i")


class LinkClosedError(Exception):
    """The other side of the link has closed."""


class Link:
    """One end of the socketpair; never blocks."""

    __slots__ = ("_socket",)

    def __init__(self, end: socket.socket) -> None:
        end.setblocking(False)
        self._socket = end

    def fileno(self) -> int:
        """Return the descriptor, for select."""
        return self._socket.fileno()

    def receive(self) -> Message | None:
        """Return the next message or None when there is none.

        Raises
        ------
        LinkClosedError
            When the other side has closed.
        MessageError
            When a packet is no message.
        """
        try:
            packet = self._socket.recv(MAX_PACKET_BYTES)
        except BlockingIOError:
            return None
        except OSError:
            raise LinkClosedError from None
        if not packet:
            raise LinkClosedError
        return decode(packet)

    def receive_passed(self) -> tuple[Message, int | None] | None:
        """Return the next message and the descriptor that came with it; None without a message.

        Raises
        ------
        LinkClosedError
            When the other side has closed.
        MessageError
            When a packet is no message.
        """
        try:
            packet, passed, _, _ = self._socket.recvmsg(
                MAX_PACKET_BYTES, socket.CMSG_LEN(_DESCRIPTOR.size), socket.MSG_CMSG_CLOEXEC
            )
        except BlockingIOError:
            return None
        except OSError:
            raise LinkClosedError from None
        if not packet:
            raise LinkClosedError
        descriptor = _DESCRIPTOR.unpack(passed[0][2])[0] if passed else None
        try:
            return decode(packet), descriptor
        except MessageError:
            if descriptor is not None:
                os.close(descriptor)
            raise

    def send(self, message: Message, descriptor: int | None = None) -> bool:
        """Send one message; return False when the other side has closed or does not read.

        A message that does not fit one packet is not sent either: the reader would see half.
        ``descriptor`` : passed on with it; the reader gets one of its own.
        """
        packet = encode(message)
        if len(packet) > MAX_PACKET_BYTES:
            return False
        try:
            if descriptor is None:
                self._socket.send(packet)
            else:
                socket.send_fds(self._socket, [packet], [descriptor])
        except OSError:
            return False
        return True

    def close(self) -> None:
        """Close this end."""
        self._socket.close()


def link_pair() -> tuple[socket.socket, socket.socket]:
    """Return two connected ends with room for a whole parameter record."""
    ends = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    for end in ends:
        end.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 2 * MAX_PACKET_BYTES)
    return ends
