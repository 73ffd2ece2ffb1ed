"""One run folder: ``run.yaml``, segments of signals, ``events.csv``, ``summary.json``."""

from __future__ import annotations

import csv
import io
import json
import os
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from aff_runtime.base.events import BY_CODE
from aff_runtime.base.printable import printable
from aff_runtime.base.signals import State
from aff_runtime.telemetry.disk_bound import delete_oldest
from aff_runtime.telemetry.segments import SegmentWriter
from aff_runtime.telemetry.summary import RunSummary

EVENT_HEADER = "time_s,tick,code,name,argument,text\n"


class RunFolder:
    """Writes one run; every refusal of the disk is counted, none is raised.

    Parameters
    ----------
    directory : folder of all runs.
    header : the ring's header (columns, start time, meta).
    context : what the supervisor knows: ``name``, ``site_text``, ``max_MB``, ``segment_s`` and
        anything else worth keeping.
    """

    def __init__(
        self, directory: Path, header: Mapping[str, Any], context: Mapping[str, Any]
    ) -> None:
        stamp = re.sub(r"[-:]", "", str(header["start_utc"]))[:15] + "Z"
        safe_name = re.sub(r"[^A-Za-z0-9_-]+", "-", str(context.get("name", "line")))
        self.path = _free_name(directory, f"{stamp}_{safe_name}")
        self._directory = directory
        self._max_bytes = int(float(context.get("max_MB", 500)) * 1e6)
        self._columns: list[str] = list(header["columns"])
        self._summary = RunSummary(self._columns, [state.name for state in State])
        self._last_s = 0.0
        self.files_lost = 0
        self.segments_deleted = 0
        self._make(header, context)
        self.signals = SegmentWriter(
            self.path, self._columns, segment_s=float(context.get("segment_s", 60))
        )

    def add(self, records: Sequence[Sequence[float]]) -> None:
        """Append signal records."""
        if not records:
            return
        self._last_s = records[-1][0]
        self._summary.add(records)
        if self.signals.append(records):
            self.bound_disk()

    def bound_disk(self) -> None:
        """Delete the oldest segments above the bound."""
        self.segments_deleted += delete_oldest(
            self._directory, max_bytes=self._max_bytes, keep=self.signals.path
        )

    def add_events(self, records: Sequence[Sequence[float]], start_ns: float) -> None:
        """Append event records (tick, t_ns, code, argument) of the ring."""
        rows: list[list[object]] = []
        for tick, t_ns, code, argument in records:
            event = BY_CODE.get(int(code))
            name, text = (event.name, event.text) if event else (f"CODE_{int(code)}", "")
            time_s = f"{(t_ns - start_ns) * 1e-9:.4f}"
            rows.append([time_s, int(tick), int(code), name, f"{argument:.10g}", text])
        self._append_events(rows)

    def add_note(self, name: str, text: str) -> None:
        """Append what the supervisor has to say (an edit, a refusal), at the present time."""
        self._append_events(
            [[f"{self._last_s:.4f}", "", "", printable(name), "", printable(text)]]
        )

    def finish(self, extra: Mapping[str, Any]) -> None:
        """Close the segment and write ``summary.json``."""
        self.signals.close()
        result = {
            **self._summary.result(),
            "rows_written": self.signals.rows_written,
            "rows_lost_to_disk": self.signals.rows_lost,
            "files_lost_to_disk": self.files_lost,
            "segments_deleted": self.segments_deleted,
            **extra,
        }
        self._write("summary.json", json.dumps(result, indent=1) + "\n")

    def _make(self, header: Mapping[str, Any], context: Mapping[str, Any]) -> None:
        """Create the folder with ``run.yaml``, the copy of the site file and the event header."""
        try:
            self.path.mkdir(parents=True)
        except OSError:
            self.files_lost += 1
            return
        about = {k: v for k, v in context.items() if k != "site_text"}
        about = _printable({**about, **header["meta"]})
        about["start_utc"] = header["start_utc"]
        about["columns"] = self._columns
        self._write("run.yaml", yaml.safe_dump(about, sort_keys=False, allow_unicode=True))
        self._write("site.yaml", str(context.get("site_text", "")))
        self._write("events.csv", EVENT_HEADER)

    def _append_events(self, rows: list[list[object]]) -> None:
        """Append rows to ``events.csv``."""
        if not rows:
            return
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerows(rows)
        try:
            with (self.path / "events.csv").open("a", encoding="utf-8", errors="replace") as file:
                file.write(text.getvalue())
        except OSError:
            self.files_lost += 1

    def _write(self, name: str, text: str) -> None:
        """Write one small file, counting a refusal."""
        try:
            (self.path / name).write_text(text, encoding="utf-8")
        except OSError:
            self.files_lost += 1


def _printable(value: Any) -> Any:
    """Return plain data whose texts, keys among them, show as themselves."""
    if isinstance(value, str):
        return printable(value)
    if isinstance(value, Mapping):
        return {printable(str(key)): _printable(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_printable(inner) for inner in value]
    return value


def _free_name(directory: Path, name: str) -> Path:
    """Return a folder path that does not exist yet."""
    path = directory / name
    serial = 1
    while os.path.lexists(path):  # a link to nowhere is there too
        serial += 1
        path = directory / f"{name}-{serial}"
    return path
