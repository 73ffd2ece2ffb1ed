"""The PLC's two register blocks as the wire sees them, and who tried to write elsewhere."""

from __future__ import annotations

from collections.abc import Sequence

from aff_runtime.base.signals import StateBits
from sim_plant.servers.plc_map import PlcMap


class Registers:
    """Holding registers: a read block that the PLC publishes, a write block for the runtime.

    Attributes
    ----------
    plc_map : where every word lives.
    read_words, write_words : the two blocks now.
    reads, writes : accesses that were granted.
    foreign_reads, foreign_writes : accesses outside the blocks, refused.
    """

    def __init__(self, plc_map: PlcMap) -> None:
        self.plc_map = plc_map
        self._read_start = plc_map.read_start
        self._write_start = plc_map.write_start
        self.read_words = [0] * plc_map.read_count
        self.write_words = [0] * plc_map.write_count
        self.reads = 0
        self.writes = 0
        self.foreign_reads = 0
        self.foreign_writes = 0

    def publish(self, read_words: Sequence[int]) -> None:
        """Show these words on the wire from now on."""
        self.read_words = list(read_words)

    def clear_writes(self) -> None:
        """Forget everything the runtime wrote."""
        self.write_words = [0] * len(self.write_words)

    def write_as_another(self, heartbeat: int) -> None:
        """Write what another runtime says that is idle: its heartbeat, intact zeros."""
        plc_map = self.plc_map
        self.clear_writes()
        self.write_words[plc_map.write["aff_heartbeat"] - plc_map.write_start] = heartbeat & 0xFFFF
        for row in plc_map.corrections:
            at = row.complement_address - plc_map.write_start
            self.write_words[at : at + row.item.length] = [0xFFFF] * row.item.length

    def write_third(self, correction_m_s: float) -> None:
        """Put ACTIVE and one correction over the runtime's; its heartbeat stays as it is."""
        plc_map = self.plc_map
        self.write_words[plc_map.write["state"] - plc_map.write_start] = int(StateBits.ACTIVE)
        for row in plc_map.corrections:
            words = row.item.to_words(correction_m_s, low_first=plc_map.low_first)
            for address, new in (
                (row.item.address, words),
                (row.complement_address, [word ^ 0xFFFF for word in words]),
            ):
                at = address - plc_map.write_start
                self.write_words[at : at + len(words)] = new

    def readable(self, address: int, count: int) -> bool:
        """Return whether one block holds all these words; count it as foreign if not."""
        held = self._block(address, count) is not None
        self.foreign_reads += not held
        return held

    def read(self, address: int, count: int) -> list[int] | None:
        """Return ``count`` words of one block (the write block reads back), or None."""
        if not self.readable(address, count):
            return None
        self.reads += 1
        return self._block(address, count)

    def write(self, address: int, words: Sequence[int]) -> bool:
        """Write inside the write block; return False, changing nothing, anywhere else."""
        at = address - self._write_start
        if at < 0 or at + len(words) > len(self.write_words):
            self.foreign_writes += 1
            return False
        self.write_words[at : at + len(words)] = words
        self.writes += 1
        return True

    def _block(self, address: int, count: int) -> list[int] | None:
        for start, words in (
            (self._read_start, self.read_words),
            (self._write_start, self.write_words),
        ):
            if start <= address and address + count <= start + len(words):
                return words[address - start : address - start + count]
        return None
