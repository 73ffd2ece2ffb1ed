"""The recorder process: ring in, run folder out; ends when the ring's writer is gone.

``python -m aff_runtime.telemetry.recorder RING RUNS_DIRECTORY``

Its standard input carries JSON lines from the supervisor: first the context of the run, then
notes ``{"name": ..., "text": ...}`` for ``events.csv``. Its standard output carries one JSON line
per second about itself; nobody has to read it. It disturbs the control process in no case: it
only ever reads the ring, and a ring it cannot follow overruns, which is counted.
"""

from __future__ import annotations

import contextlib
import os
import select
import signal
import sys
from collections.abc import Sequence
from pathlib import Path

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.runs.table import RECORDER_DIED
from aff_runtime.telemetry.recorder_messages import RecorderReport, RunContext, context_of, note_of
from aff_runtime.telemetry.ring import RingReader
from aff_runtime.telemetry.run_folder import RunFolder
from aff_runtime.telemetry.takeover import Takeover, takeover_of

POLL_S = 0.25
REPORT_NS = 1_000_000_000


class Lines:
    """Non-blocking reader of lines from a descriptor."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._rest = b""
        self.ended = False

    def read(self, timeout_s: float) -> list[bytes]:
        """Wait at most ``timeout_s`` and return the complete lines that came."""
        watched = [] if self.ended else [self._descriptor]
        ready, _, _ = select.select(watched, [], [], timeout_s)
        if not ready:
            return []
        chunk = os.read(self._descriptor, 1 << 16)
        self.ended = not chunk
        *lines, self._rest = (self._rest + chunk).split(b"\n")
        return lines


def record(ring: RingReader, folder: RunFolder, notes: Lines) -> None:
    """Follow ``ring`` into ``folder`` until its writer is gone and everything is read."""
    clock = MonotonicClock()
    start_ns = float(ring.header.meta.start_ns)
    next_report_ns = clock.now_ns()
    alive = True
    while alive:
        alive = ring.writer_alive()  # asked before reading: what it wrote last is still read
        said = notes.read(POLL_S if alive else 0.0)
        folder.add(ring.signals.read_new())  # notes get the time of the newest row
        folder.add_events(ring.events.read_new(), start_ns)
        _keep_notes(said, folder)
        if clock.now_ns() >= next_report_ns:
            next_report_ns += REPORT_NS
            _report(ring, folder)
    folder.finish(ring_overruns=ring.signals.overrun_count)
    _report(ring, folder)


def _take_over(ring: RingReader, folder: RunFolder, taken: Takeover, died: str) -> None:
    """Go on behind what another recorder wrote, and say what neither has."""
    kept = ring.signals.read_new()
    ring.signals.overrun_count = taken.lost(kept)  # what it wrote is overwritten, and not lost
    folder.add_note(RECORDER_DIED, taken.words(died, kept))
    folder.add(kept)


def _report(ring: RingReader, folder: RunFolder) -> None:
    """Say on standard output how recording goes; dropped when nobody listens."""
    left, size = folder.free_bytes()
    report = RecorderReport(
        folder=str(folder.path),
        rows=folder.signals.rows_written,
        rows_lost=folder.signals.rows_lost + folder.files_lost,
        ring_overruns=ring.signals.overrun_count,
        error=folder.signals.last_error,
        kept_bytes=folder.kept_bytes,
        max_bytes=folder.max_bytes,
        free_bytes=left,
        disk_bytes=size,
    )
    with contextlib.suppress(OSError):
        os.write(1, report.encode())


def _keep_notes(lines: Sequence[bytes], folder: RunFolder) -> None:
    """Put the supervisor's notes into ``events.csv``; junk is skipped."""
    for note in map(note_of, lines):
        if note is not None:
            folder.keep_site(note.site_hash, note.site_text)  # before the event that names it
            folder.keep_response(note.actuator, note.response)
            if note.name:
                folder.add_note(note.name, note.text)


def _first_words(notes: Lines) -> tuple[RunContext, list[bytes]]:
    """Wait for the context of the run; return it and the lines that came with it."""
    while not notes.ended:
        lines = notes.read(1.0)
        for number, line in enumerate(lines):
            context = context_of(line)
            if context is not None:
                return context, lines[number + 1 :]
    return RunContext(), []  # who started us is gone


def main(arguments: list[str]) -> int:
    """Record one run; ``arguments``: ring path, directory of runs."""
    ring_path, directory = Path(arguments[0]), Path(arguments[1])
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # ctrl-c ends the writer; we flush after it
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    signal.signal(signal.SIGHUP, signal.SIG_IGN)  # a terminal that closes, as ctrl-c
    os.set_blocking(1, False)
    notes = Lines(0)
    context, rest = _first_words(notes)
    ring = RingReader(ring_path)
    taken = takeover_of(context, ring.header)
    folder = RunFolder(directory, ring.header, context, taken)
    if taken is not None:
        _take_over(ring, folder, taken, context.died)
    folder.add(ring.signals.read_new())
    _keep_notes(rest, folder)
    record(ring, folder, notes)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
