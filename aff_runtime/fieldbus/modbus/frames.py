"""Modbus TCP frames of one register map: three requests, and the replies to them."""

from __future__ import annotations

import struct
from enum import StrEnum
from typing import Final

from aff_runtime.base.errors import ConfigError
from aff_runtime.base.signals import Outcome
from aff_runtime.fieldbus.modbus.registers import MAX_READ_WORDS, MAX_WRITE_WORDS

READ: Final = 3
WRITE: Final = 16
READ_WRITE: Final = 23

_HEADER: Final = struct.Struct(">HHH")
_TID: Final = struct.Struct(">H")
_ECHO: Final = struct.Struct(">HH")
_HEADER_BYTES: Final = 6
_LEAST_LENGTH: Final = 3  # unit id, function, one byte
_MOST_LENGTH: Final = 254  # unit id and a PDU of 253
_NO_WORDS: Final[list[int]] = []


_MEANS: Final = {
    2: "illegal data address: it has no such registers; compare the map and address_base",
    3: "illegal data value: it does not serve so many registers at once",
    4: "server device failure: its own log says why",
    5: "acknowledge: it takes its time; a cyclic exchange needs another server",
    6: "server device busy: its scan or another client keeps it",
    8: "memory parity error: the device is defective",
    10: "gateway path unavailable: check device_id and the gateway's table of devices",
    11: "gateway target does not respond: power, line and device_id of the device behind it",
}  # MODBUS Application Protocol V1.1b3, section 7


def exception_text(code: int, function: int) -> str:
    """Return what an exception reply to ``function`` says, and what to do about it."""
    if code == 1 and function == READ_WRITE:
        return (
            "the PLC does not know function 23 (exception 1): write function: fc3_fc16 into the "
            "site file"
        )
    if code == 1:
        return f"the PLC does not know function {function} (exception 1), which it must"
    means = _MEANS.get(code, "not in the standard: see the device's manual")
    return f"the PLC refuses function {function} with exception {code} ({means})"


class WireFunction(StrEnum):
    """How one tick's transaction is spelt."""

    FC23 = "fc23"
    FC3_FC16 = "fc3_fc16"
    FC3 = "fc3"


class ModbusFrames:
    """Requests and strict replies for one read block and one write block.

    Layout of a request [MODBUS Messaging on TCP/IP V1.0b, 3.1.3; Application Protocol V1.1b3, 6]:
    transaction id, protocol 0, bytes that follow, device, function, and what it asks. All but the
    first and the words that are written are the same in every tick.

    Parameters
    ----------
    device_id : unit identifier, 0..255.
    read_start, read_count : read block, wire addresses.
    write_start, write_count : write block, wire addresses.

    Raises
    ------
    ConfigError
        When a number does not fit a frame.
    """

    def __init__(
        self,
        *,
        device_id: int,
        read_start: int,
        read_count: int,
        write_start: int = 0,
        write_count: int = 0,
    ) -> None:
        if not 0 <= device_id <= 255:
            raise ConfigError(f"device_id {device_id}: Modbus allows 0..255")
        if not 1 <= read_count <= MAX_READ_WORDS or not 0 <= write_count <= MAX_WRITE_WORDS:
            raise ConfigError(
                f"{read_count} words to read and {write_count} to write: a frame carries "
                f"1..{MAX_READ_WORDS} and 0..{MAX_WRITE_WORDS}"
            )
        if not 0 <= read_start <= 0x10000 - read_count:
            raise ConfigError(f"read block at {read_start} leaves 0..65535")
        if not 0 <= write_start <= 0x10000 - write_count:
            raise ConfigError(f"write block at {write_start} leaves 0..65535")
        self.last_exception_code = 0
        self._device_id = device_id
        self._read_count = read_count
        self._write_start = write_start
        self._write_count = write_count
        read = struct.pack(">HH", read_start, read_count)
        write = struct.pack(">HHB", write_start, write_count, 2 * write_count)
        self._words = struct.Struct(f">{write_count}H")
        self._registers = struct.Struct(f">{read_count}H")
        written = self._words.size
        self._read = _after_tid(device_id, READ, read)
        self._write = _after_tid(device_id, WRITE, write, written)
        self._read_write = _after_tid(device_id, READ_WRITE, read + write, written)

    def read_request(self, tid: int) -> bytes:
        """Return the FC3 request for the read block."""
        return _TID.pack(tid) + self._read

    def write_request(self, tid: int, words: list[int]) -> bytes:
        """Return the FC16 request that writes ``words`` to the write block."""
        return _TID.pack(tid) + self._write + self._words.pack(*words)

    def read_write_request(self, tid: int, words: list[int]) -> bytes:
        """Return the FC23 request that writes ``words``, then reads the read block."""
        return _TID.pack(tid) + self._read_write + self._words.pack(*words)

    def fits(self, words: list[int]) -> bool:
        """Return True when ``words`` fill the write block exactly."""
        return len(words) == self._write_count

    def parse_reply(self, frame: bytes, function: int) -> tuple[Outcome, list[int]]:
        """Judge one complete frame whose transaction id is already known to be right.

        Parameters
        ----------
        frame : bytes of exactly one frame, as cut by ``frame_length``.
        function : the function code that was asked.

        Returns
        -------
        outcome, words
            OK with the read words (none for FC16); EXCEPTION, its code in
            ``last_exception_code``; BAD_REPLY for anything else.
        """
        if frame[6] != self._device_id:
            return Outcome.BAD_REPLY, _NO_WORDS
        if not self._has_right_shape(frame, function):
            return Outcome.BAD_REPLY, _NO_WORDS
        if frame[7] != function:
            self.last_exception_code = frame[8]
            return Outcome.EXCEPTION, _NO_WORDS
        if function == WRITE:
            echoed = _ECHO.unpack_from(frame, 8) == (self._write_start, self._write_count)
            return (Outcome.OK if echoed else Outcome.BAD_REPLY), _NO_WORDS
        return Outcome.OK, list(self._registers.unpack_from(frame, 9))

    def _has_right_shape(self, frame: bytes, function: int) -> bool:
        if frame[7] == function | 0x80:
            return len(frame) == 9
        if frame[7] != function:
            return False
        if function == WRITE:
            return len(frame) == 12
        return len(frame) == 9 + 2 * self._read_count and frame[8] == 2 * self._read_count


def _after_tid(device_id: int, function: int, asks: bytes, written: int = 0) -> bytes:
    """Return a request from behind its transaction id to where ``written`` bytes follow."""
    bytes_after = 2 + len(asks) + written  # device, function and all that comes
    return struct.pack(">HHBB", 0, bytes_after, device_id, function) + asks


def frame_length(buffer: bytearray, filled: int) -> int:
    """Return the length of the frame at the head of ``buffer``.

    Returns
    -------
    int
        Total bytes of the frame; 0 while more bytes are needed; -1 when the header breaks the
        protocol (protocol id, impossible length).
    """
    if filled < _HEADER_BYTES:
        return 0
    _, protocol, length = _HEADER.unpack_from(buffer)
    if protocol != 0 or not _LEAST_LENGTH <= length <= _MOST_LENGTH:
        return -1
    total: int = length + _HEADER_BYTES
    return total if filled >= total else 0


def transaction_id(buffer: bytearray) -> int:
    """Return the transaction id of the frame at the head of ``buffer``."""
    return buffer[0] << 8 | buffer[1]
