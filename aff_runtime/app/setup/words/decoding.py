"""The ways to read a number out of one or two words."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from aff_runtime.app.setup.words.reading import Watched

HIGH_FIRST, LOW_FIRST = "high_first", "low_first"
ORDERS = (HIGH_FIRST, LOW_FIRST)


@dataclass(frozen=True, slots=True, kw_only=True, order=True)
class Decoding:
    """One way to read a number.

    Attributes
    ----------
    address : wire address of the first word.
    type : u16, i16, u32 or i32.
    order : which word of two comes first; empty for one word.
    """

    address: int
    type: str
    order: str = ""

    @property
    def addresses(self) -> range:
        """Return the wire addresses of its words."""
        return range(self.address, self.address + (2 if self.type.endswith("32") else 1))

    def __str__(self) -> str:
        """Return it as text for eyes."""
        return f"word {self.address} {self.type} {self.order}".strip()


def values(decoding: Decoding, seen: Watched) -> tuple[int, ...]:
    """Return the counts that a decoding reads; KeyError when a word was not watched."""
    parts = [seen.words[address] for address in decoding.addresses]
    if decoding.order == LOW_FIRST:
        parts.reverse()
    bits = 16 * len(parts)
    raw = parts[0] if len(parts) == 1 else tuple(h << 16 | w for h, w in zip(*parts, strict=True))
    if decoding.type.startswith("u"):
        return raw
    sign = 1 << (bits - 1)
    return tuple((one ^ sign) - sign for one in raw)


def side_by_side(address: int, seen: Watched) -> dict[str, int]:
    """Return the last reading at ``address`` in its four decodings, as far as words are there."""
    rows = {
        "u16": Decoding(address=address, type="u16"),
        "i16": Decoding(address=address, type="i16"),
        "i32 high_first": Decoding(address=address, type="i32", order=HIGH_FIRST),
        "i32 low_first": Decoding(address=address, type="i32", order=LOW_FIRST),
    }
    return {
        name: values(row, seen)[-1]
        for name, row in rows.items()
        if all(place in seen.words for place in row.addresses)
    }


def all_decodings(seen: Watched, *, signed: bool) -> Iterator[Decoding]:
    """Yield every decoding of the watched words; where signed and unsigned agree, one of them."""
    for address in sorted(seen.words):
        for bits, order in (("16", ""), *(("32", order) for order in ORDERS)):
            if bits == "32" and address + 1 not in seen.words:
                continue
            i = Decoding(address=address, type=f"i{bits}", order=order)
            u = Decoding(address=address, type=f"u{bits}", order=order)
            if values(i, seen) == values(u, seen):
                yield i if signed else u
            else:
                yield from (i, u)
