"""Which bits follow a state of the line that the technician changes."""

from __future__ import annotations

from dataclasses import dataclass

from aff_runtime.app.setup.words.behaviour import Kind, behaviour
from aff_runtime.app.setup.words.reading import Watched


@dataclass(frozen=True, slots=True, kw_only=True, order=True)
class BitChange:
    """One bit that was steady before and after, and differs.

    ``inverted`` : it is 0 while the state that it shall mean is true.
    """

    address: int
    bit: int
    inverted: bool

    @property
    def place(self) -> str:
        """Return it as an answer: ``20.7`` or ``20.7 inverted``."""
        return f"{self.address}.{self.bit}{' inverted' if self.inverted else ''}"

    def __str__(self) -> str:
        """Return it as text for eyes."""
        return f"word {self.address} bit {self.bit}{', inverted' if self.inverted else ''}"


def changed_bits(
    before: Watched,
    after: Watched,
    *,
    true_before: bool,
    taken: frozenset[int] = frozenset(),
    owned: frozenset[tuple[int, int]] = frozenset(),
) -> list[BitChange]:
    """Return the bits that changed with a state and held still otherwise.

    Words that count, ramp or are noisy have no such bits.

    Parameters
    ----------
    before, after : words while the state held the one value, and the other.
    true_before : whether what the bit shall mean was true at first.
    taken : words of quantities that were found.
    owned : (word, bit) of states that were found: they may change along with this one.
    """
    changes = []
    for address, was in sorted(before.words.items()):
        now = after.words.get(address)
        if now is None or address in taken:
            continue
        kinds = {behaviour(one.times_s, one.words[address]).kind for one in (before, after)}
        if not kinds <= {Kind.STILL, Kind.BITS}:
            continue
        steady = 0xFFFF
        for series in (was, now):
            for word in series:
                steady &= ~(word ^ series[0])
        changed = (was[0] ^ now[0]) & steady
        for bit in range(16):
            if changed >> bit & 1 and (address, bit) not in owned:
                was_set = bool(was[0] >> bit & 1)
                changes.append(
                    BitChange(address=address, bit=bit, inverted=was_set is not true_before)
                )
    return sorted(changes, key=lambda one: (_company(changes, one), one))


def _company(changes: list[BitChange], one: BitChange) -> int:
    """Return how many bits of its word changed: those of words with few come first."""
    return sum(other.address == one.address for other in changes)
