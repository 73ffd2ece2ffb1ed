"""Bytes of a fuzzer as decisions: numbers, choices, spoilt copies. An empty source says 0."""

from __future__ import annotations

import random
import struct
from collections.abc import Sequence
from typing import TypeVar

T = TypeVar("T")


class Source:
    """Takes decisions off the front of some bytes."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._at = 0

    def __bool__(self) -> bool:
        return self._at < len(self._data)

    def take(self, count: int) -> bytes:
        part = self._data[self._at : self._at + count]
        self._at += count
        return part

    def byte(self) -> int:
        part = self.take(1)
        return part[0] if part else 0

    def word(self) -> int:
        return self.byte() << 8 | self.byte()

    def below(self, limit: int) -> int:
        return (self.byte() if limit <= 256 else self.word()) % limit

    def pick(self, choices: Sequence[T]) -> T:
        return choices[self.below(len(choices))]

    def number(self) -> float:
        """Any double, the special ones included."""
        if self.byte() & 1:
            return self.word() * 1e-5 - 0.32768
        found: float = struct.unpack("<d", self.take(8).ljust(8, b"\0"))[0]
        return found

    def spoilt(self, good: bytes) -> bytes:
        """A copy of ``good`` with up to three bytes changed, cut or put in."""
        bad = bytearray(good)
        for _ in range(self.below(4)):
            at, kind = self.below(len(bad) + 1), self.below(4)
            if kind == 0:
                bad[at:at] = self.take(1 + self.below(4))
            elif kind == 1:
                del bad[at : at + 1 + self.below(4)]
            elif bad:
                bad[at % len(bad)] = self.byte()
        return bytes(bad)


def mutations(seeds: Sequence[bytes], count: int, seed: int) -> list[bytes]:
    """``count`` inputs, the same each time: the seeds, spoilt ones, some of chance alone."""
    dice = random.Random(seed)
    made = list(seeds)
    while len(made) < count:
        if dice.random() < 0.3:
            made.append(dice.randbytes(dice.randrange(200)))
            continue
        one = bytearray(dice.choice(made))
        for _ in range(dice.randrange(1, 6)):
            at = dice.randrange(len(one) + 1)
            kind = dice.randrange(4)
            if kind == 0:
                one[at:at] = dice.randbytes(dice.randrange(1, 9))
            elif kind == 1:
                del one[at : at + dice.randrange(1, 9)]
            elif kind == 2:
                one[at : at + 4] = dice.choice((b"\0", b"\xff", b"\x80\x00", b"\x7f\xff"))
            elif one:
                one[at % len(one)] = dice.randrange(256)
        made.append(bytes(one))
    return made[:count]
