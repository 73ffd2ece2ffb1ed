"""The newest value of each signal of some frames, as they come; no control runs on this."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterable

from aff_runtime.fieldbus.can.frames import Frame
from aff_runtime.fieldbus.can.layout import Field, FrameLayout


def count_of(field: Field, data: bytes) -> int:
    """Return the bits of a field of a frame's bytes, without sign."""
    whole = int.from_bytes(data, "big" if field.big_endian else "little")
    return whole >> field.shift & field.mask


class HeardValues:
    """Takes frames, and keeps of each its newest bytes; a value need not be of a whole set.

    Attributes
    ----------
    layouts : the frames that are listened for, by identifier and whether it is a long one.
    counts : how many of each came.
    """

    def __init__(self, layouts: Iterable[FrameLayout]) -> None:
        self.layouts = {(layout.can_id, layout.extended): layout for layout in layouts}
        self.counts = dict.fromkeys(self.layouts, 0)
        self.newest: dict[str, bytes] = {}
        self._whole: dict[str, bytes] = {}  # those of the right length
        self._pages: dict[tuple[str, int], bytes] = {}

    def __bool__(self) -> bool:
        """Whether any of the frames came."""
        return any(self.counts.values())

    def take(self, frame: Frame) -> FrameLayout | None:
        """Take one frame; return its layout where it is listened for and of the right length."""
        layout = self.layouts.get((frame.can_id, frame.extended))
        if layout is None:
            return None
        self.counts[frame[:2]] += 1
        self.newest[layout.name] = frame.data
        if len(frame.data) != layout.length:
            return None
        self._whole[layout.name] = frame.data
        if layout.multiplexer is not None:
            self._pages[layout.name, count_of(layout.multiplexer, frame.data)] = frame.data
        return layout

    def whole(self, layout: FrameLayout) -> bytes | None:
        """Return the newest bytes of a frame that had the right length; None without any."""
        return self._whole.get(layout.name)

    def word(self, field: Field) -> int | None:
        """Return the bits of a word; None when nothing of its frame came."""
        data = self._data(field)
        return None if data is None else count_of(field, data)

    def value(self, field: Field) -> float:
        """Return the physical value of a signal; NaN when nothing of its frame came."""
        data = self._data(field)
        if data is None:
            return math.nan
        bits = count_of(field, data)
        if field.is_float:
            code = "f" if field.length == 32 else "d"
            number: float = struct.unpack(f">{code}", bits.to_bytes(field.length // 8, "big"))[0]
        else:
            sign = 1 << (field.length - 1) if field.signed else 0
            number = (bits ^ sign) - sign
        return number * field.factor + field.offset

    def _data(self, field: Field) -> bytes | None:
        """Return the newest bytes that carry a field."""
        if field.selector is not None:
            return self._pages.get((field.frame, field.selector))
        return self._whole.get(field.frame)
