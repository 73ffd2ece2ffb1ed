"""CAN frames to SI at the speed of the control tick: precompiled shifts, no library."""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass
from enum import IntEnum
from typing import Final

from aff_runtime.fieldbus.can.frames import Frame
from aff_runtime.fieldbus.can.layout import CanMap, Field, FrameLayout
from aff_runtime.fieldbus.liveness import HeartbeatOrder

_F32: Final = struct.Struct(">f")
_U32: Final = struct.Struct(">I")
_F64: Final = struct.Struct(">d")
_U64: Final = struct.Struct(">Q")


class Taken(IntEnum):
    """What one frame did to the reader."""

    IGNORED = 0  # nobody asked for it
    STORED = 1  # kept until the heartbeat closes the set
    SET = 2  # it closed a consistent set; ``values`` are of this set
    TORN = 3  # it closed a set with frames missing or of another scan
    BAD = 4  # wrong length


@dataclass(slots=True)
class _Slot:
    """Latest bits of one frame (of one selector of a multiplexed frame)."""

    allowed_scans: int
    waited_for: bool  # part of a set
    current: bool = True  # of the last set's scan; always, where it is part of it
    scans: int = 1 << 30
    little: int = 0
    big: int = 0


@dataclass(frozen=True, slots=True)
class _ReadFrame:
    layout: FrameLayout
    slots: dict[int, _Slot]  # by selector; -1 for a plain frame
    closes: bool


@dataclass(frozen=True, slots=True)
class _Row:
    """One channel, compiled."""

    slot: _Slot
    big: bool
    shift: int
    mask: int
    sign_bit: int
    modulus: int
    float_bits: int
    factor: float
    offset: float
    minimum: float
    maximum: float
    scale: float


class CanReader:
    """Gathers the frames of one PLC scan into a consistent set.

    The frame with the PLC's heartbeat closes a set: every other frame must have come since the
    last one (a multiplexed one within two rounds of all its pages), and a frame with a counter
    must carry the low bits of this very heartbeat. Frames that carry channels for the record
    alone are no part of it: what is not of this scan in them is NaN. What a heartbeat that steps
    back is worth, ``HeartbeatOrder`` says.

    A physical value outside its signal's range is NaN. An angle goes on where it starts over, also
    across a loss: what it was then is the same place of the turn.

    Attributes
    ----------
    heartbeat, status, roll_id, values : of the last consistent set.
    aff_echo : our heartbeat that the PLC took, of that set; None where the map has none.
    applied : per correction what the PLC applies of it, SI, of that set; NaN where the map has no
        such reading, empty where it has none at all.
    torn, bad_lengths, out_of_order, out_of_range : counts since construction.
    """

    def __init__(self, can_map: CanMap) -> None:
        self.heartbeat = 0
        self.status = 0
        self.roll_id = 0
        self.aff_echo: int | None = None
        self.values: tuple[float, ...] = (math.nan,) * len(can_map.channels)
        self.applied = (math.nan,) * len(can_map.applied)
        self.torn = 0
        self.bad_lengths = 0
        self.out_of_order = 0
        self.out_of_range = 0
        self._known = False
        self.heartbeat_modulus = can_map.plc_heartbeat.mask + 1
        self._order = HeartbeatOrder(can_map.plc_heartbeat.mask)
        self._frames: dict[tuple[int, bool], _ReadFrame] = {}
        slots: dict[tuple[str, int], _Slot] = {}
        for layout in can_map.frames_of(can_map.read_fields):
            mine = [field for field in can_map.read_fields if field.frame == layout.name]
            selectors = {-1 if field.selector is None else field.selector for field in mine}
            waited = layout.name in can_map.set_frames
            own = {one: _Slot(_allowed_scans(layout, selectors, one), waited) for one in selectors}
            slots |= {(layout.name, selector): slot for selector, slot in own.items()}
            closes = layout.name == can_map.plc_heartbeat.frame
            self._frames[(layout.can_id, layout.extended)] = _ReadFrame(layout, own, closes)
        self._slots = tuple(slots.values())
        self._heartbeat_row = _row(can_map.plc_heartbeat, slots)
        self._status_row = _row(can_map.status, slots)
        self._roll_row = _row(can_map.roll_id, slots)
        self._echo_row = None if can_map.aff_echo is None else _row(can_map.aff_echo, slots)
        self._rows = tuple(
            _row(channel.field, slots, modulus=channel.modulus, scale=channel.scale)
            for channel in can_map.channels
        )
        self._applied_rows = tuple(
            None if shown is None else _row(shown.field, slots, scale=shown.scale)
            for shown in can_map.applied
        )
        counters = [
            _row(layout.counter, {(layout.name, -1): slot})
            for layout in can_map.frames_of(can_map.read_fields)
            if layout.counter is not None
            for (name, _), slot in slots.items()
            if name == layout.name
        ]
        self._counters = tuple(row for row in counters if row.slot.waited_for)
        self._others = tuple(slot for slot in self._slots if not slot.waited_for)
        self._other_counters = tuple(row for row in counters if not row.slot.waited_for)
        self._turned: list[int | None] = [None] * len(self._rows)

    @property
    def ids(self) -> tuple[tuple[int, bool], ...]:
        """Return identifier and format of every frame that is read."""
        return tuple(self._frames)

    def reset(self) -> None:
        """Forget what was heard: the next set starts the heartbeat afresh."""
        self._known = False
        self._order.forget()
        for slot in self._slots:
            slot.scans = 1 << 30

    def take(self, frame: Frame) -> Taken:
        """Take one frame of the bus."""
        known = self._frames.get((frame.can_id, frame.extended))
        if known is None:
            return Taken.IGNORED
        layout, data = known.layout, frame.data
        if len(data) != layout.length:
            self.bad_lengths += 1
            return Taken.BAD
        little, big = int.from_bytes(data, "little"), int.from_bytes(data, "big")
        selector = -1
        if layout.multiplexer is not None:
            field = layout.multiplexer
            selector = ((big if field.big_endian else little) >> field.shift) & field.mask
        for wanted, slot in known.slots.items():
            if wanted in (-1, selector):
                slot.little, slot.big, slot.scans = little, big, 0
        return self._close() if known.closes else Taken.STORED

    def _close(self) -> Taken:
        heartbeat = _bits(self._heartbeat_row)
        repeated = self._known and heartbeat == self.heartbeat
        if not self._in_order(heartbeat):
            self.out_of_order += 1
            return Taken.TORN
        whole = self._is_whole(heartbeat)
        self._look_at_others(heartbeat, repeated)
        if not repeated:
            for slot in self._slots:
                slot.scans += 1
        if not whole:
            self.torn += not repeated
            return Taken.TORN
        self.heartbeat = heartbeat
        self._known = True
        self.status = _bits(self._status_row)
        self.roll_id = _bits(self._roll_row)
        if self._echo_row is not None:
            self.aff_echo = _bits(self._echo_row)
        self._decode()
        return Taken.SET

    def _in_order(self, heartbeat: int) -> bool:
        return self._order.takes(heartbeat, self.heartbeat if self._known else None)

    def _is_whole(self, heartbeat: int) -> bool:
        repeated = self._known and heartbeat == self.heartbeat
        for slot in self._slots:
            if slot.waited_for and slot.scans > slot.allowed_scans + repeated:
                return False
        for row in self._counters:
            if row.slot.allowed_scans == 0 and _bits(row) != heartbeat & row.mask:
                return False
        return True

    def _look_at_others(self, heartbeat: int, repeated: bool) -> None:
        """Note which frames that belong to no set are of this scan."""
        for slot in self._others:
            slot.current = slot.scans <= slot.allowed_scans + repeated
        for row in self._other_counters:
            if row.slot.allowed_scans == 0 and _bits(row) != heartbeat & row.mask:
                row.slot.current = False

    def _decode(self) -> None:
        self.values = tuple([self._value(row, i) for i, row in enumerate(self._rows)])
        if self._applied_rows:
            shown = [math.nan if r is None else self._value(r) for r in self._applied_rows]
            self.applied = tuple(shown)

    def _value(self, row: _Row, index: int = -1) -> float:
        if not row.slot.current:
            return math.nan
        raw = _bits(row)
        if row.float_bits:
            number: float = _float_of(raw, row.float_bits)
        else:
            number = (raw ^ row.sign_bit) - row.sign_bit
        physical = number * row.factor + row.offset
        if not row.minimum <= physical <= row.maximum:
            self.out_of_range += 1
            physical = math.nan
        elif row.modulus:
            physical = self._go_on(index, int(number)) * row.factor + row.offset
        return physical * row.scale

    def _go_on(self, index: int, count: int) -> int:
        """Return the count that is nearest to the last one among those that look the same."""
        last, modulus = self._turned[index], self._rows[index].modulus
        if last is not None:
            step = (count - last) % modulus
            count = last + (step - modulus if 2 * step >= modulus else step)
        self._turned[index] = count
        return count


def _allowed_scans(layout: FrameLayout, selectors: set[int], selector: int) -> int:
    """Return after how many scans the bits of one page, or of every page (-1), are too old."""
    if layout.multiplexer is None:
        return 0
    return 2 * (len(selectors) if selector == -1 else max(len(selectors), layout.pages))


def _row(
    field: Field, slots: dict[tuple[str, int], _Slot], *, modulus: int = 0, scale: float = 1.0
) -> _Row:
    slot = slots[(field.frame, -1 if field.selector is None else field.selector)]
    return _Row(
        slot,
        field.big_endian,
        field.shift,
        field.mask,
        1 << (field.length - 1) if field.signed else 0,
        modulus,
        field.length if field.is_float else 0,
        field.factor,
        field.offset,
        field.minimum,
        field.maximum,
        scale,
    )


def _bits(row: _Row) -> int:
    return ((row.slot.big if row.big else row.slot.little) >> row.shift) & row.mask


def _float_of(raw: int, bits: int) -> float:
    packed = _U32.pack(raw) if bits == 32 else _U64.pack(raw)
    number: float = (_F32 if bits == 32 else _F64).unpack(packed)[0]
    return number
