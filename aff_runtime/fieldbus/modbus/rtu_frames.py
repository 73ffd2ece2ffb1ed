"""Frames of Modbus RTU under the TCP transport: MBAP frames become serial ones and back.

A serial frame has no transaction id, so a reply is given the id of the one request in flight.
"""

from __future__ import annotations

from typing import Final

from aff_runtime.fieldbus.modbus.tcp_wire import SPOILT

MOST_BYTES: Final = 256


def crc16(data: bytes) -> int:
    """Return the CRC of Modbus over Serial Line V1.02, 6.2.2 (polynomial 0xA001, start 0xFFFF)."""
    crc = 0xFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ 0xA001 if crc & 1 else crc >> 1
    return crc


def rtu_of(frame: bytes) -> bytes:
    """Return the serial frame of an MBAP frame."""
    body = frame[6:]
    return body + crc16(body).to_bytes(2, "little")


def reply_length(buffer: bytes) -> int:
    """Return the length of the reply at the head of ``buffer``; 0 too early, -1 no reply."""
    if len(buffer) < 3:
        return 0
    function = buffer[1]
    if function & 0x80:
        return 5
    if function in (3, 23):
        return 5 + buffer[2]
    return 8 if function == 16 else -1


class RtuFraming:
    """The one request in flight, and what has come of its reply."""

    def __init__(self) -> None:
        self._head = b""
        self._buffer = b""

    @property
    def wanted(self) -> int:
        """Bytes that are missing of the reply as far as it says, at least 1."""
        return max(1, reply_length(self._buffer) - len(self._buffer))

    def clear(self) -> None:
        """Forget the request and what came."""
        self._head = self._buffer = b""

    def request(self, frame: bytes) -> bytes:
        """Return the serial frame of a request; what came before it is dropped."""
        self._buffer = b""
        self._head = frame[:4]
        return rtu_of(frame)

    def deliver(self, more: bytes, into: memoryview) -> int:
        """Take bytes; return the length of a whole reply as MBAP, 0 none yet, SPOILT no reply."""
        if not self._head:
            self._buffer = b""  # nobody asked
            return 0
        self._buffer += more
        length = reply_length(self._buffer)
        if length < 0 or len(self._buffer) > MOST_BYTES:
            return self._spoilt()
        if length == 0 or len(self._buffer) < length:
            return 0
        reply, self._buffer = self._buffer[:length], b""
        body = reply[:-2]
        if crc16(body) != int.from_bytes(reply[-2:], "little"):
            return self._spoilt()
        frame = self._head + len(body).to_bytes(2, "big") + body
        self._head = b""
        into[: len(frame)] = frame
        return len(frame)

    def nothing_more(self) -> int:
        """Judge what has come when a tick finds nothing new; SPOILT for a piece of a reply.

        No device pauses within a frame for longer than 1.5 characters (Modbus over Serial Line
        V1.02, 2.5.1.1): a byte was lost, or the one that says how many follow was spoilt.
        """
        return self._spoilt() if self._buffer else 0

    def _spoilt(self) -> int:
        """End the request; what still comes is nobody's."""
        self.clear()
        return SPOILT
