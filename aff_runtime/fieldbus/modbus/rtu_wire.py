"""Modbus RTU on a serial line, under the TCP transport.

The transport's rules stay as they are (one request in flight, hard deadline, strict replies);
whatever lies in the line's buffer when a request leaves is thrown away (`rtu_frames`).
"""

from __future__ import annotations

from typing import Final

import serial

from aff_runtime.fieldbus.modbus.byte_stream import CLOSED, Connecting
from aff_runtime.fieldbus.modbus.rtu_frames import MOST_BYTES, RtuFraming

_FAULTS: Final = (serial.SerialException, OSError, ValueError)


class RtuWire:
    """``ByteStream`` over a serial line.

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
        self._framing = RtuFraming()
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
            request = self._framing.request(frame)
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
            more = line.read(self._framing.wanted if wait_ns > 0 else MOST_BYTES)
        except _FAULTS:
            return CLOSED
        if not more and wait_ns <= 0:
            return self._framing.nothing_more()
        return self._framing.deliver(more, into)

    def close(self, *, abort: bool) -> None:
        """Close the line."""
        del abort
        line, self._line = self._line, None
        self._framing.clear()
        if line is not None:
            try:
                line.close()
            except _FAULTS:
                return
