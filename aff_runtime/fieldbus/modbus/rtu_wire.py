"""Modbus RTU under the TCP transport: MBAP frames become serial ones and back.

The transport's rules stay as they are (one request in flight, hard deadline, strict replies); a
serial line has no transaction id, so whatever lies in its buffer when a request leaves is thrown
away, and a reply is given the id of the one request in flight.
"""

from __future__ import annotations

from typing import Final

import serial

from aff_runtime.fieldbus.modbus.tcp_wire import CLOSED, Connecting

_MOST_BYTES: Final = 256
_FAULTS: Final = (serial.SerialException, OSError, ValueError)


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


class RtuWire:
    """``Wire`` over a serial line.

    Parameters
    ----------
    device : path of the line.
    baud, parity, stop_bits : as the device is set; parity N, E or O.
    """

    lossy = False

    def __init__(self, device: str, *, baud: int, parity: str, stop_bits: int) -> None:
        self._device = device
        self._settings = {"baudrate": baud, "parity": parity, "stopbits": stop_bits}
        self._line: serial.Serial | None = None
        self._head = b""
        self._buffer = b""
        self.why_closed = ""

    def start_connect(self) -> bool:
        """Open the line; False when it cannot be opened."""
        self.close(abort=True)
        try:
            self._line = serial.Serial(
                self._device, timeout=0, write_timeout=0, exclusive=True, **self._settings
            )
        except _FAULTS as error:
            self.why_closed = f"the serial line {self._device} does not open: {error}"
            return False
        self.why_closed = ""
        return True

    def connecting(self) -> Connecting:
        """Return UP: a line that is open is connected."""
        return Connecting.UP if self._line is not None else Connecting.FAILED

    def send(self, frame: bytes) -> bool:
        """Hand over one request; what was left from before is dropped."""
        line = self._line
        if line is None:
            return False
        try:
            line.reset_input_buffer()
            self._buffer = b""
            self._head = frame[:4]
            request = rtu_of(frame)
            return bool(line.write(request) == len(request))
        except _FAULTS:
            return False

    def receive(self, into: memoryview, wait_ns: int) -> int:
        """Wait at most ``wait_ns`` for bytes; return a whole reply as MBAP, 0 for none yet."""
        line = self._line
        if line is None:
            return CLOSED
        try:
            line.timeout = max(0, wait_ns) * 1e-9
            wanted = max(1, reply_length(self._buffer) - len(self._buffer))
            self._buffer += line.read(wanted if wait_ns > 0 else _MOST_BYTES)
        except _FAULTS:
            return CLOSED
        if not self._head:
            self._buffer = b""  # nobody asked
            return 0
        length = reply_length(self._buffer)
        if length < 0 or len(self._buffer) > _MOST_BYTES:
            return CLOSED
        if length == 0 or len(self._buffer) < length:
            return 0
        return self._deliver(self._buffer[:length], into)

    def close(self, *, abort: bool) -> None:
        """Close the line."""
        del abort
        line, self._line = self._line, None
        self._buffer = b""
        self._head = b""
        if line is not None:
            try:
                line.close()
            except _FAULTS:
                return

    def _deliver(self, reply: bytes, into: memoryview) -> int:
        self._buffer = b""
        body = reply[:-2]
        if crc16(body) != int.from_bytes(reply[-2:], "little"):
            return 0
        frame = self._head + len(body).to_bytes(2, "big") + body
        self._head = b""
        into[: len(frame)] = frame
        return len(frame)
