"""Words of the wire to SI and back, at the speed of the control tick."""

from __future__ import annotations

import math
import struct
from typing import Final

from aff_runtime.base.signals import Command
from aff_runtime.fieldbus.modbus.registers import (
    Correction,
    Register,
    RegisterMap,
    WordOrder,
    WordType,
)

_INTEGER: Final = 0
_COUNTER: Final = 1
_FLOAT: Final = 2

_RANGE: Final[dict[WordType, tuple[float, float]]] = {
    WordType.I16: (-32768.0, 32767.0),
    WordType.I32: (-2147483648.0, 2147483647.0),
    WordType.F32: (-3.4028234663852886e38, 3.4028234663852886e38),
}
_F32: Final = struct.Struct(">f")
_U32: Final = struct.Struct(">I")
_ReadRow = tuple[int, int, int, int, float, int]
"""Kind, high and low word (-1 for none), sign bit, SI units per count, range in counts."""


class WordCodec:
    """Decodes the read block and encodes the write block of one register map.

    Wrapping counters are unwrapped by steps of less than half their range, which needs the last
    reading: ``reset`` forgets it, and the next reading starts again at the raw count. A count
    beyond the range after which it starts over is no reading: NaN.

    Parameters
    ----------
    register_map : the words and their meaning.
    """

    def __init__(self, register_map: RegisterMap) -> None:
        start = register_map.read_start
        self.read_count: Final = register_map.read_count
        self.channel_count: Final = len(register_map.channels)
        self._heartbeat_at = register_map.plc_heartbeat - start
        self._status_at = register_map.status - start
        self._status_rows = tuple(
            (place.address - start, 1 << place.bit, place.inverted, int(place.means))
            for place in register_map.status_places
        )
        self._roll_id_at = register_map.roll_id - start
        self._aff_echo_at = _offset(register_map.aff_echo, start)
        self._read_rows = tuple(_read_row(channel, start) for channel in register_map.channels)
        self._applied_rows = tuple(
            None if register is None else _read_row(register, start)
            for register in register_map.applied
        )
        self._counts: list[int | None] = [None] * self.channel_count
        self._values = [math.nan] * self.channel_count

        start = register_map.write_start
        self._words = [0] * register_map.write_count
        self._own_heartbeat_at = register_map.aff_heartbeat - start
        self._state_at = register_map.state - start
        self._echo_at = register_map.echo - start
        self._alarm_at = _offset(register_map.alarm, start)
        self._limit_at = _offset(register_map.limit, start)
        self._revision_at = _offset(register_map.config_revision, start)
        self._write_rows = tuple(_write_row(item, start) for item in register_map.corrections)

    def reset(self) -> None:
        """Forget the last counts of wrapping counters."""
        self._counts = [None] * self.channel_count

    def decode(self, words: list[int]) -> tuple[int, int, int, tuple[float, ...]]:
        """Return heartbeat, status, roll id and the SI value per channel.

        Parameters
        ----------
        words : the read block, ``read_count`` words of 0..65535.
        """
        values = self._values
        counts = self._counts
        for slot, (kind, high, low, sign_bit, scale, size) in enumerate(self._read_rows):
            raw = words[low] if high < 0 else (words[high] << 16) | words[low]
            if kind == _FLOAT:
                values[slot] = _F32.unpack(_U32.pack(raw))[0] * scale
                continue
            raw = (raw ^ sign_bit) - sign_bit
            if kind == _COUNTER:
                if abs(raw) > size:
                    values[slot] = math.nan
                    continue
                last = counts[slot]
                if last is not None:  # the step since then, taken the short way round
                    half = size // 2
                    raw = last + (raw - last + half) % size - half
                counts[slot] = raw
            values[slot] = raw * scale
        return (
            words[self._heartbeat_at],
            self._status(words) if self._status_rows else words[self._status_at],
            words[self._roll_id_at],
            tuple(values),
        )

    def _status(self, words: list[int]) -> int:
        """Return the status in our own order, gathered from where the PLC has its bits."""
        status = 0
        for at, mask, inverted, means in self._status_rows:
            if (words[at] & mask == 0) is inverted:
                status |= means
        return status

    def aff_echo(self, words: list[int]) -> int | None:
        """Return our heartbeat that the PLC took; None where the map has no such word."""
        at = self._aff_echo_at
        return None if at < 0 else words[at]

    def applied(self, words: list[int]) -> tuple[float, ...]:
        """Return the SI value per correction that the PLC applies; NaN where it shows none."""
        return tuple([_plain(row, words) for row in self._applied_rows])

    def encode(self, command: Command) -> list[int]:
        """Return the write block; the list is reused by the next call.

        Corrections are rounded to counts and clipped to the range of their type; a value that is
        not finite, or missing, goes out as 0.
        """
        words = self._words
        words[self._own_heartbeat_at] = command.heartbeat & 0xFFFF
        words[self._state_at] = command.state_bits & 0xFFFF
        words[self._echo_at] = command.echo & 0xFFFF
        if self._alarm_at >= 0:
            words[self._alarm_at] = command.alarm & 0xFFFF
        if self._revision_at >= 0:
            words[self._revision_at] = command.config_revision & 0xFFFF
        corrections = command.corrections
        given = len(corrections)
        for slot, row in enumerate(self._write_rows):
            is_float, scale, least, most, high, low, copy_high, copy_low = row
            counts = corrections[slot] / scale if slot < given else 0.0
            if not -math.inf < counts < math.inf:
                counts = 0.0
            counts = least if counts < least else most if counts > most else counts
            raw = _U32.unpack(_F32.pack(counts))[0] if is_float else round(counts) & 0xFFFFFFFF
            words[low] = raw & 0xFFFF
            if high >= 0:
                words[high] = raw >> 16
            if copy_low >= 0:
                words[copy_low] = ~raw & 0xFFFF
            if copy_high >= 0:
                words[copy_high] = (~raw >> 16) & 0xFFFF
        if self._limit_at >= 0:
            words[self._limit_at] = self._limit_word(command.limits)
        return words

    def _limit_word(self, limits: tuple[float, ...]) -> int:
        if not limits or not self._write_rows:
            return 0
        counts = limits[0] / abs(self._write_rows[0][1])
        return round(min(counts, 65535.0)) if counts > 0.0 else 0


def _plain(row: _ReadRow | None, words: list[int]) -> float:
    """Return the SI value of one reading that never starts over."""
    if row is None:
        return math.nan
    kind, high, low, sign_bit, scale, _ = row
    raw = words[low] if high < 0 else (words[high] << 16) | words[low]
    if kind == _FLOAT:
        number: float = _F32.unpack(_U32.pack(raw))[0]
        return number * scale
    return ((raw ^ sign_bit) - sign_bit) * scale


def _offset(address: int | None, start: int) -> int:
    return -1 if address is None else address - start


def _halves(address: int, register: Register) -> tuple[int, int]:
    """Positions of the high and the low word; the high one is -1 for a single word."""
    if register.type.word_count == 1:
        return -1, address
    if register.word_order is WordOrder.HIGH_FIRST:
        return address, address + 1
    return address + 1, address


def _read_row(register: Register, start: int) -> _ReadRow:
    high, low = _halves(register.address - start, register)
    bits = 16 * register.type.word_count
    if register.type is WordType.F32:
        kind, sign_bit = _FLOAT, 0
    else:
        kind = _COUNTER if register.wraps else _INTEGER
        signed = register.type in (WordType.I16, WordType.I32)
        whole = register.wraps and not register.wraps_after  # its sign is one way round of two
        sign_bit = (1 << (bits - 1)) if signed or whole else 0
    size = register.wraps_after or 1 << bits
    return kind, high, low, sign_bit, register.scale, size


def _write_row(
    item: Correction, start: int
) -> tuple[bool, float, float, float, int, int, int, int]:
    register = item.register
    least, most = _RANGE[register.type]
    high, low = _halves(register.address - start, register)
    copy_high, copy_low = -1, -1
    if item.complement_address is not None:
        copy_high, copy_low = _halves(item.complement_address - start, register)
    is_float = register.type is WordType.F32
    return is_float, register.scale, least, most, high, low, copy_high, copy_low
