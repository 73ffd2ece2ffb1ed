"""How one number of the PLC sits in 16-bit words: type, scale, word order, clipping."""

from __future__ import annotations

import math
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

WordType = Literal["u16", "i16", "u32", "i32", "f32"]

_NUMBER: dict[WordType, struct.Struct] = {
    "u16": struct.Struct(">H"),
    "i16": struct.Struct(">h"),
    "u32": struct.Struct(">I"),
    "i32": struct.Struct(">i"),
    "f32": struct.Struct(">f"),
}
_WORDS = {count: struct.Struct(f">{count}H") for count in (1, 2)}
_RANGE: dict[WordType, tuple[int, int]] = {
    "u16": (0, 0xFFFF),
    "i16": (-0x8000, 0x7FFF),
    "u32": (0, 0xFFFF_FFFF),
    "i32": (-0x8000_0000, 0x7FFF_FFFF),
}
_ONE_WORD = frozenset({"u16", "i16"})
_LARGEST_F32 = struct.unpack(">f", b"\x7f\x7f\xff\xff")[0]


@dataclass(frozen=True, slots=True, kw_only=True)
class RegisterItem:
    """One named number of the map.

    Attributes
    ----------
    name : name of the channel or of the actuator.
    address : wire address of its first word, zero based.
    type : u16, i16, u32, i32 or f32.
    scale : SI units per count.
    wraps : True for a counter that rolls over instead of clipping at the end of its range.
    """

    name: str
    address: int
    type: WordType = "u16"
    scale: float = 1.0
    wraps: bool = False

    @property
    def length(self) -> int:
        """Return the number of 16-bit words."""
        return 1 if self.type in _ONE_WORD else 2

    @property
    def range_si(self) -> tuple[float, float]:
        """Return the smallest and the largest value that it can say, SI."""
        low, high = _RANGE.get(self.type, (-_LARGEST_F32, _LARGEST_F32))
        ends = (low * self.scale, high * self.scale)
        return min(ends), max(ends)

    def to_words(self, value_si: float, *, low_first: bool = False) -> tuple[int, ...]:
        """Return ``value_si`` quantised to counts and clipped to the type's range.

        NaN becomes the quiet NaN of f32 and, as many devices do it, the end of the range that
        nobody measures: the smallest signed or the largest unsigned count.
        """
        if self.type == "f32":
            high, low = _WORDS[2].unpack(_NUMBER["f32"].pack(self._f32(value_si)))
        else:
            counts = self._counts(value_si)
            if self.type in _ONE_WORD:
                return (counts & 0xFFFF,)
            high, low = counts >> 16 & 0xFFFF, counts & 0xFFFF
        return (low, high) if low_first else (high, low)

    def from_words(self, words: Sequence[int], *, low_first: bool = False) -> float:
        """Return the SI value held by ``words`` (``length`` of them)."""
        ordered = tuple(reversed(words)) if low_first else tuple(words)
        packed = _WORDS[len(ordered)].pack(*ordered)
        counts: float = _NUMBER[self.type].unpack(packed)[0]
        return counts * self.scale

    def reading(self, words: Sequence[int], *, low_first: bool = False) -> float:
        """Return the SI value that ``words`` say; NaN for the count that says there is none."""
        value = self.from_words(words, low_first=low_first)
        if self.type == "f32" or self.wraps:
            return value
        blank = self.to_words(math.nan, low_first=low_first)
        return math.nan if tuple(words) == blank else value

    def _f32(self, value_si: float) -> float:
        value = value_si / self.scale
        return value if math.isnan(value) else min(max(value, -_LARGEST_F32), _LARGEST_F32)

    def _counts(self, value_si: float) -> int:
        low, high = _RANGE[self.type]
        if math.isnan(value_si):
            return low if low < 0 else high
        counts = value_si / self.scale
        if self.wraps and math.isfinite(value_si):
            return (round(counts) - low) % (high - low + 1) + low
        if counts <= low:
            return low
        return high if counts >= high else round(counts)
