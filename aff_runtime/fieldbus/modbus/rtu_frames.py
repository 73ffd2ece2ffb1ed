"""Frames of Modbus RTU under the TCP transport: MBAP frames become serial ones and back.

A serial frame has no transaction id, so a reply is given the id of the one request in flight. One
request more may be without an answer, of another function: a reply names its function, and a
device answers in the order in which it was asked.
"""

from __future__ import annotations

from typing import Final

from aff_runtime.fieldbus.modbus.byte_stream import DOUBTED, LATE, SPOILT, UNHEARD

MOST_BYTES: Final = 256
_MOST_PLACES: Final = 8
"""Places behind noise at which a reply is looked for; a CRC of each costs up to 0.1 ms."""
_SILENT_TICKS: Final = 2  # a reply that is late by less than a cycle is waited for


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
    """The request in flight, what has come of its reply, and the request given up before it."""

    def __init__(self) -> None:
        self._head = b""
        self._buffer = b""
        self._unit = self._asked = 0
        self._late = 0  # function of the request given up, whose reply may still come
        self._overtaken = False  # that reply came, the one to the request in flight did not
        self._noisy = (
            False  # what came begins behind noise, at the first place that may be a reply
        )
        self._silent_ticks = 0

    @property
    def wanted(self) -> int:
        """Bytes that are missing of the reply as far as it says, at least 1."""
        return max(1, reply_length(self._buffer) - len(self._buffer))

    def clear(self) -> None:
        """Forget the requests and what came."""
        self._head = self._buffer = b""
        self._late = self._silent_ticks = 0
        self._overtaken = self._noisy = False

    def request(self, frame: bytes) -> bytes:
        """Return the serial frame of a request; what came before it is dropped."""
        if self._head and not self._late:
            self._late = self._asked
        self._buffer = b""
        self._head = frame[:4]
        self._unit, self._asked = frame[6], frame[7]
        if self._late == self._asked:  # who only reads has nothing to tell its replies by
            self._late = 0
        self._silent_ticks = 0
        self._overtaken = self._noisy = False
        return rtu_of(frame)

    def deliver(self, more: bytes, into: memoryview) -> int:
        """Take bytes; return the length of a whole reply as MBAP, 0 none yet, or what came.

        SPOILT, DOUBTED, or LATE.
        """
        if not self._head:
            self._buffer = b""  # nobody asked
            return 0
        self._buffer += more
        late, places = False, 0
        while True:
            length = reply_length(self._buffer)
            can_be = 0 <= length <= MOST_BYTES and len(self._buffer) <= 2 * MOST_BYTES
            if can_be and (length == 0 or len(self._buffer) < length):
                return LATE if late else 0
            reply, rest = self._buffer[:length], self._buffer[length:]
            body = reply[:-2]
            if not can_be or crc16(body) != int.from_bytes(reply[-2:], "little"):
                if self._late and (self._noisy or self._is_noise()):
                    places += 1
                    self._drop_noise()
                    if places > _MOST_PLACES:
                        self._buffer, self._noisy = b"", False
                    continue
                return self._spoilt()
            if body[1] & 0x7F != self._late:
                break
            self._buffer, self._late = rest, 0
            late = self._overtaken = True
        frame = self._head + len(body).to_bytes(2, "big") + body
        self.clear()
        into[: len(frame)] = frame
        return len(frame)

    def nothing_more(self) -> int:
        """Judge what has come when a tick finds nothing new; 0 to go on waiting.

        SPOILT for a piece of a reply: no device pauses within a frame for longer than 1.5
        characters (Modbus over Serial Line V1.02, 2.5.1.1), so a byte was lost, or the one that
        says how many follow was spoilt. A byte or two are the noise of a line that turns round:
        the reply may still come. SPOILT too when the reply to the request before came and none
        to this one, which a device that was busy did not take. UNHEARD for a second tick without
        anything, once: two requests of which nothing is known are a line that is gone.
        """
        if reply_length(self._buffer):
            if not (self._late and (self._noisy or self._is_noise())):
                return self._spoilt()
            self._buffer, self._noisy = b"", False
            return 0
        self._buffer, self._noisy = b"", False
        if not self._head:
            return 0
        self._silent_ticks += 1
        if self._overtaken:
            return self._end(may_come=True)
        return UNHEARD if self._silent_ticks >= _SILENT_TICKS and not self._late else 0

    def _is_noise(self) -> bool:
        """Return whether what came is of no reply: one names the device, or its function."""
        unit, function = self._buffer[0], self._buffer[1] & 0x7F
        named = function == self._asked or 0 < function == self._late
        return unit != self._unit and not named

    def _drop_noise(self) -> None:
        """Drop what comes before the next place that may begin a reply to one of two requests.

        Both are waited for: of two requests nothing more is known after noise.
        """
        came, functions = self._buffer, (self._asked, self._late)
        for place in range(1, len(came)):
            names_function = came[place + 1 : place + 2]
            if came[place] == self._unit and (
                not names_function or names_function[0] & 0x7F in functions
            ):
                self._buffer, self._noisy = came[place:], True
                return
        self._buffer, self._noisy = b"", False

    def _spoilt(self) -> int:
        """Judge what came and is no reply: whose it was, and what may still come.

        Noise leaves the reply to the one request to come. Otherwise the request ends; of two, the
        reply to the younger may still come, unless it was its own.
        """
        function = self._buffer[1] & 0x7F
        is_last = function == self._asked or not (self._late or self._overtaken)
        return self._end(may_come=self._is_noise() or not is_last)

    def _end(self, *, may_come: bool) -> int:
        """End the request; its reply may still come, or will not."""
        asked = self._asked
        self.clear()
        if not may_come:
            return SPOILT
        self._late = asked
        return DOUBTED
