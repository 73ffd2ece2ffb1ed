"""Serial-line CAN (slcan) with a read path of its own: whole chunks, no byte at a time.

python-can's slcan asks the tty for one byte per call and sleeps two seconds when it opens; a
control tick has time for neither. Frames: ``tIIILDD..`` (11 bit), ``TIIIIIIIILDD..`` (29 bit);
``sb...`` is the adapter's report of bus-off, as the Linux driver reads it.
"""

from __future__ import annotations

import contextlib
import os
import select
import termios
import tty
from collections import deque
from typing import Any, Final

from aff_runtime.base.python_can import can

BITRATE_CODE: Final = {
    10_000: "S0",
    20_000: "S1",
    50_000: "S2",
    100_000: "S3",
    125_000: "S4",
    250_000: "S5",
    500_000: "S6",
    800_000: "S7",
    1_000_000: "S8",
}
_CHUNK: Final = 4096
_LONGEST_LINE: Final = 64
_BUS_OFF: Final = 0x40
_HEX: Final = frozenset(b"0123456789ABCDEFabcdef")


class SlcanTtyBus(can.BusABC):
    """python-can bus over a tty (adapter, or a pty whose other end is a simulated plant).

    Parameters
    ----------
    channel : path of the tty.
    bitrate : one of the slcan rates, bit/s.

    Raises
    ------
    OSError, ValueError
        The tty cannot be opened, or the rate has no slcan code.
    """

    def __init__(self, channel: str, bitrate: int = 500_000, **kwargs: Any) -> None:
        if bitrate not in BITRATE_CODE:
            raise ValueError(f"slcan has no code for {bitrate} bit/s")
        self._fd = os.open(channel, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        with contextlib.suppress(termios.error):
            tty.setraw(self._fd, termios.TCSANOW)
            termios.tcflush(self._fd, termios.TCIOFLUSH)
        self._rest = b""
        self._ready: deque[can.Message] = deque()
        self.channel_info = f"slcan {channel}"
        super().__init__(channel=channel, **kwargs)
        self._write(f"C\r{BITRATE_CODE[bitrate]}\rO\r".encode())

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Write one frame; the tty's buffer takes it or the bus is dead."""
        del timeout
        head = f"T{msg.arbitration_id:08X}" if msg.is_extended_id else f"t{msg.arbitration_id:03X}"
        self._write(f"{head}{msg.dlc:X}{bytes(msg.data).hex().upper()}\r".encode())

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        if not self._ready and select.select((self._fd,), (), (), timeout)[0]:
            self._fill()
        return (self._ready.popleft() if self._ready else None), False

    def fileno(self) -> int:
        """Return the descriptor to wait for."""
        return self._fd

    def shutdown(self) -> None:
        """Close the channel and the tty."""
        super().shutdown()
        if self._fd >= 0:
            with contextlib.suppress(OSError):
                os.write(self._fd, b"C\r")
            os.close(self._fd)
            self._fd = -1

    def _write(self, text: bytes) -> None:
        if os.write(self._fd, text) != len(text):
            raise OSError("the serial line takes no more frames")

    def _fill(self) -> None:
        try:
            chunk = os.read(self._fd, _CHUNK)
        except BlockingIOError:
            return
        if not chunk:
            raise OSError("the serial line hung up")
        *lines, rest = (self._rest + chunk).split(b"\r")
        self._rest = rest if len(rest) <= _LONGEST_LINE else b""
        for line in lines:
            message = parse_line(line.lstrip(b"\x07zZ"))
            if message is not None:
                self._ready.append(message)


def parse_line(line: bytes) -> can.Message | None:
    """Return the frame of one line without its ``CR``; None for answers and for garbage."""
    kind = line[:1]
    if kind == b"s" and line[1:2] == b"b":
        return can.Message(arbitration_id=_BUS_OFF, is_error_frame=True, is_extended_id=False)
    digits = {b"t": 3, b"T": 8}.get(kind)
    if digits is None or not set(line[1:]) <= _HEX:  # int() would take signs, blanks, underscores
        return None
    try:
        can_id = int(line[1 : 1 + digits], 16)
        length = int(line[1 + digits : 2 + digits], 16)
        data = bytes.fromhex(line[2 + digits : 2 + digits + 2 * length].decode("ascii"))
    except ValueError:
        return None
    stamp = len(line) - 2 - digits - 2 * length  # some adapters add four digits of time
    if length > 8 or len(data) != length or stamp not in (0, 4):
        return None
    last = 0x7FF if digits == 3 else 0x1FFF_FFFF
    if can_id > last:
        return None
    return can.Message(arbitration_id=can_id, is_extended_id=digits == 8, data=data)
