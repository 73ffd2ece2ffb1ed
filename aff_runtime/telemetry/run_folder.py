"""One run folder: ``run.yaml``, site files, segments, events, responses, ``summary.json``."""

from __future__ import annotations

import contextlib
import csv
import errno
import io
import os
import re
from collections.abc import Sequence
from pathlib import Path

from aff_runtime.base.events import BY_CODE
from aff_runtime.base.printable import printable
from aff_runtime.base.runs.responses import (
    LARGEST_RESPONSE,
    MOST_RESPONSES,
    RESPONSE_FILE,
    response_file,
)
from aff_runtime.base.runs.site_in_force import file_of
from aff_runtime.base.signals import State
from aff_runtime.telemetry.disk_bound import delete_oldest, free_bytes, used_bytes
from aff_runtime.telemetry.header import RingHeader
from aff_runtime.telemetry.recorder_messages import NOT_SAID, RunContext
from aff_runtime.telemetry.run_about import RunAbout
from aff_runtime.telemetry.segments import SegmentWriter
from aff_runtime.telemetry.summary import RunSummary, Summary
from aff_runtime.telemetry.takeover import Takeover

EVENT_HEADER = "time_s,tick,code,name,argument,text\n"
MOST_SITES = 300
"""Site files that are kept of one run beside its first, as many as the history of settings has."""


class RunFolder:
    """Writes one run; every refusal of the disk is counted, none is raised.

    Parameters
    ----------
    directory : folder of all runs.
    header : the ring's header (columns, start time, meta).
    context : what the supervisor knows.
    taken : what another recorder left of this run; None where it begins.

    Attributes
    ----------
    max_bytes : what all runs together may take.
    kept_bytes : what they took when the last segment had ended; `NOT_SAID` before.
    """

    def __init__(
        self,
        directory: Path,
        header: RingHeader,
        context: RunContext,
        taken: Takeover | None = None,
    ) -> None:
        self._taken = taken
        self.path = _new_path(directory, header, context) if taken is None else taken.folder
        self._directory = directory
        self.max_bytes = int(context.max_MB * 1e6)
        self._columns: list[str] = list(header.columns)
        self._summary = RunSummary(self._columns, [state.name for state in State])
        self._last_s = 0.0 if taken is None else taken.time_s
        self._missing: dict[str, str] = {}
        self._sites = {file_of(context.site_hash)} if taken is None else set[str]()
        self._responses = set[str]() if taken is None else _responses_in(taken.folder)
        self._is_made = taken is not None
        self.files_lost = 0
        self.segments_deleted = 0
        self.kept_bytes = NOT_SAID
        if taken is None:
            self._make(header, context)
        else:
            self.keep_site(context.site_hash, context.site_text)
        self.signals = SegmentWriter(
            self.path,
            self._columns,
            segment_s=context.segment_s,
            after=0 if taken is None else taken.segment,
        )

    def add(self, records: Sequence[Sequence[float]]) -> None:
        """Append signal records; those that another recorder wrote are left out."""
        if self._taken is not None:
            records = self._taken.beyond(records)
        if not records:
            return
        self._last_s = records[-1][0]
        self._summary.add(records)
        if self.signals.append(records):
            self._make_up_for()
            self.bound_disk()

    def bound_disk(self) -> None:
        """Delete the oldest segments above the bound."""
        self.segments_deleted += delete_oldest(
            self._directory, max_bytes=self.max_bytes, keep=self.signals.path
        )
        self.kept_bytes = used_bytes(self._directory)

    def free_bytes(self) -> tuple[int, int]:
        """Return what the disk of the runs has left, and its size, bytes; else `NOT_SAID`."""
        return free_bytes(self._directory) or (NOT_SAID, NOT_SAID)

    def add_events(self, records: Sequence[Sequence[float]], start_ns: float) -> None:
        """Append event records (tick, t_ns, code, argument) of the ring."""
        rows: list[list[object]] = []
        for tick, t_ns, code, argument in records:
            event = BY_CODE.get(int(code))
            name, text = (event.name, event.text) if event else (f"CODE_{int(code)}", "")
            time_s = f"{(t_ns - start_ns) * 1e-9:.4f}"
            rows.append([time_s, int(tick), int(code), name, f"{argument:.10g}", text])
        if self._taken is not None:
            rows = [row for row in rows if not self._taken.is_known(row)]
        if rows:
            self._append_events(rows)

    def add_note(self, name: str, text: str) -> None:
        """Append what the supervisor has to say (an edit, a refusal), at the present time."""
        self._append_events(
            [[f"{self._last_s:.4f}", "", "", printable(name), "", printable(text)]]
        )

    def keep_site(self, site_hash: str, text: str) -> None:
        """Keep a site file that runs from now on, unless the folder has it; no text is none."""
        name = file_of(site_hash)
        if not text or not name or name in self._sites or len(self._sites) > MOST_SITES:
            return
        self._sites.add(name)
        if not (self.path / name).exists():
            self._missing[name] = text
            self._make_up_for()

    def keep_response(self, actuator: str, text: str) -> None:
        """Keep a response that was measured, unless the folder has it; no text is none."""
        name = response_file(actuator, text)
        is_full = len(self._responses) >= MOST_RESPONSES or len(text) > LARGEST_RESPONSE
        if not text or is_full or name in self._responses:
            return
        self._responses.add(name)
        self._missing[name] = text
        self._make_up_for()

    def finish(self, *, ring_overruns: int) -> None:
        """Close the segment and write ``summary.json``."""
        self.signals.close()
        self._make_up_for()
        summary = Summary(
            statistics=self._summary.result(),
            from_s=0.0 if self._taken is None else self._taken.time_s,
            rows_written=self.signals.rows_written,
            rows_lost_to_disk=self.signals.rows_lost,
            files_lost_to_disk=self.files_lost,
            segments_deleted=self.segments_deleted,
            ring_overruns=ring_overruns,
        )
        self._write("summary.json", summary.encode())

    def _make(self, header: RingHeader, context: RunContext) -> None:
        """Create the folder with ``run.yaml``, the copy of the site file and the event header."""
        about = RunAbout(
            context=context, meta=header.meta, start_utc=header.start_utc, columns=header.columns
        )
        self._missing = {
            "run.yaml": about.encode(),
            "site.yaml": context.site_text,
            "events.csv": EVENT_HEADER,
        }
        self._make_up_for()

    def _make_up_for(self) -> None:
        """Write what a full disk refused: a folder without ``run.yaml`` is never cleared."""
        if not self._missing:
            return
        try:
            self.path.mkdir(parents=True, exist_ok=self._is_made)
        except OSError:
            self.files_lost += 1
            return
        self._is_made = True
        for name, text in list(self._missing.items()):
            done = self._append_events([]) if name == "events.csv" else self._write(name, text)
            if done:
                del self._missing[name]

    def _append_events(self, rows: list[list[object]]) -> bool:
        """Append rows to ``events.csv``, below its header; False when the disk refuses them."""
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerows(rows)
        try:
            _append_whole(
                self.path / "events.csv",
                text.getvalue().encode("utf-8", "replace"),
                head=EVENT_HEADER.encode(),
            )
        except OSError:
            self.files_lost += 1
            return False
        return True

    def _write(self, name: str, text: str) -> bool:
        """Write one small file, whole or not at all, counting a refusal; False for one."""
        part = self.path / f"{name}.part"
        try:
            part.write_text(text, encoding="utf-8")
            part.replace(self.path / name)
        except OSError:
            with contextlib.suppress(OSError):
                part.unlink(missing_ok=True)
            self.files_lost += 1
            return False
        return True


def _new_path(directory: Path, header: RingHeader, context: RunContext) -> Path:
    """Return a path for a run that begins: UTC and line."""
    stamp = re.sub(r"[-:]", "", header.start_utc)[:15] + "Z"
    safe_name = re.sub(r"[^A-Za-z0-9_-]+", "-", context.name)
    return _free_name(directory, f"{stamp}_{safe_name}")


def _responses_in(folder: Path) -> set[str]:
    """Return the files of responses that a folder has."""
    try:
        return {name for name in os.listdir(folder) if RESPONSE_FILE.fullmatch(name)}
    except OSError:
        return set()


def _append_whole(path: Path, added: bytes, *, head: bytes) -> None:
    """Append bytes, all of them or none: half a row would swallow the next one.

    ``head`` : what an empty file begins with.
    """
    with path.open("ab", buffering=0) as file:
        there = file.tell()
        added = added if there else head + added
        try:
            taken = file.write(added)
            if taken < len(added):
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))
        except OSError:
            file.truncate(there)
            raise


def _free_name(directory: Path, name: str) -> Path:
    """Return a folder path that does not exist yet."""
    path = directory / name
    serial = 1
    while os.path.lexists(path):  # a link to nowhere is there too
        serial += 1
        path = directory / f"{name}-{serial}"
    return path
