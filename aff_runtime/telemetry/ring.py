"""The shared-memory ring between the control process and everybody who watches it.

A file in memory without a name: readers get a descriptor from the writer, and nobody else can
find it, take its name first or remove it. In it: 16 bytes ``magic, version, header length``, a
JSON header (column names with units, layout, who writes, when it started), the ring of signals
(one record per tick), the ring of events. The writer holds an exclusive lock on the file for its
life: the kernel drops it when the process dies in any way, so a reader knows without pids or
timeouts. The newest record is the status.
"""

from __future__ import annotations

import contextlib
import fcntl
import mmap
import os
import struct
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from aff_runtime.base.clock import wall_time_iso
from aff_runtime.base.errors import AffError
from aff_runtime.telemetry.header import RingHeader, RunMeta
from aff_runtime.telemetry.slots import SlotReader, SlotWriter, ring_bytes

MAGIC = b"AFFRING\0"
VERSION = 1
EVENT_COLUMNS = ("tick", "t_ns", "code", "argument")
_PREFIX = struct.Struct("=8sII")
_OFFSET_DIGITS = 64  # room for the two offsets, which are 0 while the head is measured


class RingWriter:
    """Creates the ring and appends to it; used by the control process alone.

    Parameters
    ----------
    columns : names with units of one signal record.
    meta : what a reader of the run should know of the writer.
    capacity : signal records kept; ``event_capacity`` likewise.

    Raises
    ------
    AffError
        When there is no memory for the ring.
    """

    def __init__(
        self,
        columns: Sequence[str],
        *,
        meta: RunMeta,
        capacity: int = 4096,
        event_capacity: int = 1024,
    ) -> None:
        header, signals_at, events_at, size = _layout(columns, meta, capacity, event_capacity)
        self._fd = os.memfd_create("aff-runtime-ring")
        try:
            os.fchmod(self._fd, 0o600)
            fcntl.flock(self._fd, fcntl.LOCK_EX)
            # every page is there from the start: one that is missing later would kill the writer
            os.posix_fallocate(self._fd, 0, size)
            self._map = mmap.mmap(self._fd, size)
            self._map.madvise(mmap.MADV_DONTFORK)  # a child's mapping would keep the lock
        except OSError as error:
            os.close(self._fd)
            raise AffError(
                f"no memory for a ring of {size / 1e6:.0f} MB ({error.strerror}); free some"
            ) from error
        self._map[: len(header)] = header
        view = memoryview(self._map)
        self._signals = SlotWriter(
            view, offset_bytes=signals_at, n_values=len(columns), capacity=capacity
        )
        self._events = SlotWriter(
            view, offset_bytes=events_at, n_values=len(EVENT_COLUMNS), capacity=event_capacity
        )
        self.write = self._signals.write

    def open_for_readers(self) -> int:
        """Return a new descriptor that reads the ring and does not share the writer's lock."""
        return os.open(f"/proc/self/fd/{self._fd}", os.O_RDONLY | os.O_CLOEXEC)

    def event(self, tick: int, t_ns: int, code: int, argument: float = 0.0) -> None:
        """Append one event (code of ``base.events``)."""
        self._events.write((tick, t_ns, code, argument))

    def close(self) -> None:
        """Drop the lock: readers finish what is there and end."""
        fcntl.flock(self._fd, fcntl.LOCK_UN)  # the mapping holds a copy of the descriptor
        os.close(self._fd)


class RingReader:
    """Reads the ring of another process.

    Parameters
    ----------
    source : path of a descriptor that the writer has passed on, ``/dev/fd/N``, which is opened
        anew; or a descriptor, which is taken over: for who may not open the file.

    Raises
    ------
    AffError
        When the file is not a ring of this version.
    """

    def __init__(self, source: Path | int) -> None:
        flags = os.O_RDONLY | os.O_CLOEXEC
        self._fd = os.open(source, flags) if isinstance(source, Path) else source
        try:
            self._map = mmap.mmap(self._fd, 0, access=mmap.ACCESS_READ)
            self.header = _read_header(self._map, source)
        except (ValueError, OSError, AffError):
            os.close(self._fd)
            raise
        view = memoryview(self._map)
        self.columns = self.header.columns
        self.signals = SlotReader(
            view,
            offset_bytes=self.header.signals_at,
            n_values=len(self.columns),
            capacity=self.header.capacity,
        )
        self.events = SlotReader(
            view,
            offset_bytes=self.header.events_at,
            n_values=len(EVENT_COLUMNS),
            capacity=self.header.event_capacity,
        )

    def fileno(self) -> int:
        """Return the descriptor of the file."""
        return self._fd

    def status(self) -> dict[str, float] | None:
        """Return the newest record by column name, or None before the first tick."""
        record = self.signals.latest()
        return None if record is None else dict(zip(self.columns, record, strict=True))

    def writer_alive(self) -> bool:
        """Return whether the writing process still lives."""
        try:
            fcntl.flock(self._fd, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
        fcntl.flock(self._fd, fcntl.LOCK_UN)
        return False

    def close(self) -> None:
        """Release the file; the mapping lasts as long as anybody holds a view of it."""
        with contextlib.suppress(OSError):
            os.close(self._fd)


def _layout(
    columns: Sequence[str], meta: RunMeta, capacity: int, event_capacity: int
) -> tuple[bytes, int, int, int]:
    """Return the header bytes, the offsets of both rings and the file size."""
    page = mmap.PAGESIZE
    header = RingHeader(
        columns=tuple(columns),
        capacity=capacity,
        event_capacity=event_capacity,
        signals_at=0,
        events_at=0,
        writer_pid=os.getpid(),
        start_utc=wall_time_iso(),
        meta=meta,
    )
    text_bytes = len(header.encode()) + _OFFSET_DIGITS
    signals_at = (_PREFIX.size + text_bytes + page - 1) // page * page
    events_at = signals_at + ring_bytes(len(columns), capacity)
    size = events_at + ring_bytes(len(EVENT_COLUMNS), event_capacity)
    text = replace(header, signals_at=signals_at, events_at=events_at).encode()
    return _PREFIX.pack(MAGIC, VERSION, len(text)) + text, signals_at, events_at, size


def _read_header(memory: mmap.mmap, source: Path | int) -> RingHeader:
    """Return the header of a mapped ring file."""
    path = source if isinstance(source, Path) else f"descriptor {source}"
    magic, version, length = _PREFIX.unpack_from(memory, 0)
    if magic != MAGIC or version != VERSION:
        raise AffError(f"{path}: not a ring of version {VERSION}; is it from another release?")
    try:
        return RingHeader.decode(memory[_PREFIX.size : _PREFIX.size + length])
    except (KeyError, TypeError, ValueError) as error:
        raise AffError(f"{path}: its head is unreadable ({error}); restart the service") from error
