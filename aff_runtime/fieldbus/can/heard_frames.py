"""What was heard of the frames of a map, for eyes: each value from the newest frame that has it.

No control runs on this: it does not ask for a whole set, it says what keeps one from coming.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator

from aff_runtime.fieldbus.can.frames import Frame
from aff_runtime.fieldbus.can.layout import CanMap, Field, FrameLayout


class HeardFrames:
    """Counts and newest bytes per frame; how often the PLC's heartbeat moved.

    Attributes
    ----------
    moves : frames with a heartbeat other than the one before.
    """

    def __init__(self, can_map: CanMap) -> None:
        self.moves = 0
        self._map = can_map
        self._layouts = {
            (layout.can_id, layout.extended): layout
            for layout in can_map.frames_of(can_map.read_fields)
        }
        self._counts = dict.fromkeys(self._layouts, 0)
        self._newest: dict[str, bytes] = {}
        self._whole: dict[str, bytes] = {}  # those of the right length
        self._pages: dict[tuple[str, int], bytes] = {}
        self._strange = dict.fromkeys((x.name for x in self._layouts.values()), 0)
        self._last = -1

    def __bool__(self) -> bool:
        """Whether any frame of the map came."""
        return any(self._counts.values())

    def take(self, frame: Frame) -> None:
        """Take one frame of the bus; others than the map's are let pass."""
        layout = self._layouts.get((frame.can_id, frame.extended))
        if layout is None:
            return
        self._counts[frame[:2]] += 1
        self._newest[layout.name] = frame.data
        if len(frame.data) != layout.length:
            return
        self._whole[layout.name] = frame.data
        if layout.multiplexer is not None:
            self._pages[layout.name, _count(layout.multiplexer, frame.data)] = frame.data
        if layout.name == self._map.plc_heartbeat.frame:
            self._close(_count(self._map.plc_heartbeat, frame.data))

    def word(self, field: Field) -> int | None:
        """Return the bits of a word; None when nothing of its frame came."""
        data = self._data(field)
        return None if data is None else _count(field, data)

    def value(self, field: Field) -> float:
        """Return the physical value of a signal; NaN when nothing of its frame came."""
        data = self._data(field)
        if data is None:
            return math.nan
        bits = _count(field, data)
        if field.is_float:
            code = "f" if field.length == 32 else "d"
            number: float = struct.unpack(f">{code}", bits.to_bytes(field.length // 8, "big"))[0]
        else:
            sign = 1 << (field.length - 1) if field.signed else 0
            number = (bits ^ sign) - sign
        return number * field.factor + field.offset

    def frame_lines(self, span_s: float) -> Iterator[str]:
        """Yield one line per frame of the map: how often, its raw bytes, what is wrong with it."""
        for key, layout in self._layouts.items():
            count, data = self._counts[key], self._newest.get(layout.name, b"")
            period = f"{span_s * 1e3 / count:7.2f} ms" if count else "  silent"
            line = f"0x{layout.can_id:03X} {layout.name:20} {count:5} {period}  "
            remark = ""
            if count and self._is_other_length(layout):
                remark = f"  WRONG LENGTH: {len(data)} bytes, the map says {layout.length}"
            yield f"{line}{data.hex(' ').upper()}{remark}"

    def hindrance(self) -> str:
        """Return why no whole set came, in words; empty when nothing is found."""
        silent = [
            f"0x{layout.can_id:03X} {layout.name}"
            for key, layout in self._layouts.items()
            if not self._counts[key]
        ]
        if silent:
            return f"silent: {', '.join(silent)}. Check identifier or node id, and its sender"
        short = [x.name for x in self._layouts.values() if self._is_other_length(x)]
        if short:
            return f"wrong length: {', '.join(short)}. Compare with the sender's mapping"
        strange = [f"{name}.Counter" for name, count in self._strange.items() if count]
        if strange:
            beat = self._map.plc_heartbeat
            return (
                f"{', '.join(strange)} differs from the low bits of {beat}. It must repeat them, "
                f"and {beat.frame} be sent last in a scan"
            )
        return ""

    def _close(self, heartbeat: int) -> None:
        self.moves += self._last not in (-1, heartbeat)
        self._last = heartbeat
        for layout in self._layouts.values():
            counter, data = layout.counter, self._whole.get(layout.name)
            if counter is not None and layout.multiplexer is None and data is not None:
                self._strange[layout.name] += _count(counter, data) != heartbeat & counter.mask

    def _data(self, field: Field) -> bytes | None:
        """Return the newest bytes that carry a field."""
        if field.selector is not None:
            return self._pages.get((field.frame, field.selector))
        return self._whole.get(field.frame)

    def _is_other_length(self, layout: FrameLayout) -> bool:
        return len(self._newest.get(layout.name, b"")) != layout.length


def _count(field: Field, data: bytes) -> int:
    whole = int.from_bytes(data, "big" if field.big_endian else "little")
    return whole >> field.shift & field.mask
