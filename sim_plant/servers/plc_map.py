"""The PLC's own register map: where each word lives; shares no code with the runtime's map."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from aff_runtime.base.signals import Status
from sim_plant.servers.words import RegisterItem


@dataclass(frozen=True, slots=True, kw_only=True)
class CorrectionItem:
    """One correction the PLC takes: its word, its ones complement copy, the PLC's own limit."""

    item: RegisterItem
    complement_address: int
    limit_m_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class StatusBit:
    """Where a PLC with an order of its own shows one status bit; ``inverted``: 0 means yes."""

    flag: Status
    address: int
    bit: int
    inverted: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class PlcMap:
    """Where every word of the PLC lives (wire addresses) and how its safety half is set.

    Attributes
    ----------
    read, write : single u16 words by name (heartbeats, status, state, ...).
    channels : measured channels in the read block.
    corrections : one per actuator, in the write block.
    applied : where the read block shows what of a correction is applied; by actuator's name.
    read_start, read_count, write_start, write_count : the two contiguous blocks.
    watchdog_s, regain_s : time without a new heartbeat that trips, and what each new one takes
        off it; the correction is zero ``fade_s`` after the trip.
    fade_s : time of the ramp to zero.
    permissives : status bits that must all be set for a correction to count.
    scan_s : time of a scan; 0: the sample time of the line.
    status_bits : of a PLC with an order of its own; empty: AFF's order, in the word ``status``.
    """

    read: Mapping[str, int]
    write: Mapping[str, int]
    channels: tuple[RegisterItem, ...]
    corrections: tuple[CorrectionItem, ...]
    low_first: bool
    read_start: int
    read_count: int
    write_start: int
    write_count: int
    watchdog_s: float
    regain_s: float
    fade_s: float
    permissives: Status
    applied: tuple[RegisterItem, ...] = ()
    scan_s: float = 0.0
    status_bits: tuple[StatusBit, ...] = ()

    def encode_read(
        self,
        words: Mapping[str, int],
        values_si: Mapping[str, float],
        applied_si: Mapping[str, float],
    ) -> list[int]:
        """Return the read block for the u16 ``words``, the channels and what is applied."""
        block = [0] * self.read_count
        for name, address in self.read.items():
            block[address - self.read_start] = words[name] & 0xFFFF
        if self.status_bits:
            self._put_status_bits(block, words["status"])
        for items, values in ((self.channels, values_si), (self.applied, applied_si)):
            for item in items:
                said = item.to_words(values[item.name], low_first=self.low_first)
                at = item.address - self.read_start
                block[at : at + len(said)] = said
        return block

    def _put_status_bits(self, block: list[int], status: int) -> None:
        """Show the status in the PLC's own order; a bit without a place is not shown."""
        block[self.read["status"] - self.read_start] = 0
        for place in self.status_bits:
            if bool(status & place.flag) is not place.inverted:
                block[place.address - self.read_start] |= 1 << place.bit

    def read_value(self, block: Sequence[int], item: RegisterItem) -> float:
        """Return what the read block says of a channel or of what is applied, SI."""
        return item.reading(self.read_slice(block, item), low_first=self.low_first)

    def read_slice(self, block: Sequence[int], item: RegisterItem) -> Sequence[int]:
        """Return the words of a channel, or of what is applied, in the read block."""
        at = item.address - self.read_start
        return block[at : at + item.length]

    def swap_read(self, block: Sequence[int]) -> list[int]:
        """Return the read block with the two words of every 32-bit channel exchanged."""
        swapped = list(block)
        for item in self.channels:
            if item.length == 2:
                at = item.address - self.read_start
                swapped[at], swapped[at + 1] = block[at + 1], block[at]
        return swapped

    def write_word(self, block: Sequence[int], name: str) -> int:
        """Return one u16 word of the write block."""
        return block[self.write[name] - self.write_start]

    def decode_correction(
        self, block: Sequence[int], correction: CorrectionItem
    ) -> tuple[float, bool]:
        """Return a correction in m/s and whether its complement matches."""
        item = correction.item
        at = item.address - self.write_start
        copy_at = correction.complement_address - self.write_start
        words = block[at : at + item.length]
        copies = block[copy_at : copy_at + item.length]
        intact = all(word ^ copy == 0xFFFF for word, copy in zip(words, copies, strict=True))
        return item.from_words(words, low_first=self.low_first), intact
