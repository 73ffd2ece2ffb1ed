"""One ring of fixed records of float64 in shared memory: one writer, any number of readers.

Slot layout: one 64-bit sequence word, then the values. Record ``k`` (from 0) lies in slot
``k % capacity``; its word is ``2k + 1`` while it is being written and ``2k + 2`` when complete.
The head word holds the number of complete records. Words are single aligned 64-bit stores, so a
reader that sees ``2k + 2`` before and after its copy has an untorn record ``k`` (on processors
that keep stores in order, x86-64; elsewhere leave a record of distance, as the recorder does).
"""

from __future__ import annotations

import struct
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

_WORD_BYTES = 8


def ring_bytes(n_values: int, capacity: int) -> int:
    """Return the size of a ring with its head word, bytes."""
    return _WORD_BYTES * (1 + capacity * (1 + n_values))


class SlotWriter:
    """The only writer of one ring.

    Parameters
    ----------
    buffer : writable memory; ``offset_bytes`` must be a multiple of 8.
    n_values : values per record.
    capacity : records kept.
    """

    __slots__ = ("_bytes", "_capacity", "_count", "_head", "_packer", "_stride", "_words")

    def __init__(
        self, buffer: memoryview, *, offset_bytes: int, n_values: int, capacity: int
    ) -> None:
        self._words = buffer.cast("Q")
        self._head = offset_bytes // _WORD_BYTES
        self._stride = 1 + n_values
        self._capacity = capacity
        self._count = 0
        self._packer = struct.Struct(f"={n_values}d")
        self._bytes = buffer.cast("B")
        self._words[self._head] = 0

    def write(self, values: Sequence[float]) -> None:
        """Append one record of ``n_values`` numbers; overwrites the oldest."""
        count = self._count
        word = self._head + 1 + (count % self._capacity) * self._stride
        words = self._words
        words[word] = 2 * count + 1
        self._packer.pack_into(self._bytes, (word + 1) * _WORD_BYTES, *values)
        words[word] = 2 * count + 2
        self._count = count + 1
        words[self._head] = self._count


class SlotReader:
    """One reader of one ring; it remembers where it is and counts what it missed.

    Attributes
    ----------
    overrun_count : records overwritten before they were read, or while.
    """

    def __init__(
        self, buffer: memoryview, *, offset_bytes: int, n_values: int, capacity: int
    ) -> None:
        self._words = buffer.cast("Q")
        self._bytes = buffer.cast("B")
        self._head = offset_bytes // _WORD_BYTES
        self._stride = 1 + n_values
        self._capacity = capacity
        self._unpacker = struct.Struct(f"={n_values}d")
        size = capacity * self._stride
        at = offset_bytes + _WORD_BYTES
        words = np.frombuffer(buffer, dtype=np.uint64, count=size, offset=at)
        self._slots = words.reshape(capacity, self._stride)
        self._values = self._slots.view(np.float64)
        self._next = 0
        self.overrun_count = 0

    def written_count(self) -> int:
        """Return how many records the writer has completed."""
        return self._words[self._head]

    def latest(self) -> tuple[float, ...] | None:
        """Return the newest complete record, or None before the first; it stays unread."""
        for _ in range(self._capacity):
            count = self.written_count()
            if count == 0:
                return None
            record = self._copy(count - 1)
            if record is not None:
                return record
        return None

    def read_new(self, limit: int = 1_000_000) -> list[tuple[float, ...]]:
        """Return at most ``limit`` unread records in order; skipped ones are counted."""
        records: list[tuple[float, ...]] = []
        while len(records) < limit:
            written = self.written_count()
            if self._next >= written:
                break
            oldest = written - self._capacity + 1  # the slot after the head may be in the making
            if self._next < oldest:
                self.overrun_count += oldest - self._next
                self._next = oldest
                continue
            record = self._copy(self._next)
            if record is None:
                self.overrun_count += 1
            else:
                records.append(record)
            self._next += 1
        return records

    def read_rows(self) -> NDArray[np.float64]:
        """Return all unread records as rows, (n, n_values); skipped ones are counted.

        The same records as ``read_new``, at a tenth of its time: for who reads every tick.
        """
        written = self.written_count()
        begin = min(max(self._next, written - self._capacity + 1), written)
        index = np.arange(begin, written, dtype=np.uint64)
        places = index % np.uint64(self._capacity)
        complete = np.uint64(2) * index + np.uint64(2)
        whole = self._slots[places, 0] == complete
        rows = self._values[places, 1:]
        whole &= self._slots[places, 0] == complete
        self.overrun_count += max(0, written - self._next) - int(whole.sum())
        self._next = max(self._next, written)
        found: NDArray[np.float64] = rows[whole]
        return found

    def _copy(self, index: int) -> tuple[float, ...] | None:
        """Return record ``index`` or None when it is torn or gone."""
        word = self._head + 1 + (index % self._capacity) * self._stride
        complete = 2 * index + 2
        if self._words[word] != complete:
            return None
        values = self._unpacker.unpack_from(self._bytes, (word + 1) * _WORD_BYTES)
        return values if self._words[word] == complete else None
