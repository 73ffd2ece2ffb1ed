"""What a recorder takes over from one that died: where its rows and events end, what is lost.

A run is one folder, whoever writes it: the next recorder goes on in a new segment behind the torn
one, with the first tick that is not in a file. The ring keeps the ticks in between.
"""

from __future__ import annotations

import csv
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import yaml

from aff_runtime.base.errors import AffError
from aff_runtime.base.runs.files import open_plain
from aff_runtime.base.runs.segment import segments_of
from aff_runtime.base.runs.table import first_rows, read_table
from aff_runtime.base.runs.window import RunWindow
from aff_runtime.telemetry.header import RingHeader
from aff_runtime.telemetry.recorder_messages import RunContext
from aff_runtime.telemetry.run_about import RunAbout

TICK = "tick"
SUMMARY = "summary.json"
_LARGEST_ABOUT, _LARGEST_EVENTS = 1 << 20, 64 << 20

EventKey = tuple[str, str, str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Takeover:
    """A run that another recorder began.

    Attributes
    ----------
    folder : of the run.
    segment : number of its newest segment.
    tick, time_s : of the last whole row. ``tick_at`` : place of the tick in a record.
    events : those of the ring that are in ``events.csv``.
    """

    folder: Path
    segment: int
    tick: float
    time_s: float
    tick_at: int
    events: frozenset[EventKey]

    def beyond(self, records: Sequence[Sequence[float]]) -> Sequence[Sequence[float]]:
        """Return the records that are in no file yet."""
        return [record for record in records if record[self.tick_at] > self.tick]

    def lost(self, records: Sequence[Sequence[float]]) -> int:
        """Return how many ticks are in no file and not in the ring, by its oldest records."""
        return max(0, round(records[0][self.tick_at] - self.tick) - 1) if records else 0

    def is_known(self, row: Sequence[object]) -> bool:
        """Return whether a row of ``events.csv`` is in it."""
        time_s, tick, code, _, argument, _ = map(str, row)
        return (time_s, tick, code, argument) in self.events

    def words(self, how: str, records: Sequence[Sequence[float]]) -> str:
        """Return what ``events.csv`` says of it; ``how`` the recorder ended.

        ``records`` : the oldest that the ring has.
        """
        lost = self.lost(records)
        said = "no tick is lost"
        if lost:
            gone_s = records[0][0] - self.time_s
            said = f"{lost} ticks are lost, nothing is recorded for {gone_s:.3g} s"
        goes_on = f"another one goes on behind segment {self.segment}"
        return f"{how or 'the recorder died'}, {goes_on}: {said}"


def takeover_of(context: RunContext, header: RingHeader) -> Takeover | None:
    """Return where to go on in ``context.takes_over``; None where a new folder has to begin.

    That is where none is named, its rows are not of this ring, or its files cannot be read.
    """
    folder = Path(context.takes_over)
    if not context.takes_over or TICK not in header.columns or (folder / SUMMARY).exists():
        return None
    try:
        with open_plain(folder / "run.yaml") as file:
            about = RunAbout.decode(file.read(_LARGEST_ABOUT).decode("utf-8", "replace"))
        if about.columns != header.columns or about.meta.start_ns != header.meta.start_ns:
            return None
        last = first_rows(folder)[1][-1]
        window = RunWindow(folder=folder, from_s=last.values["time_s"])
        table = read_table(window, keep=lambda name: name == TICK)
        events = _events(folder / "events.csv")
    except (AffError, OSError, KeyError, IndexError, TypeError, AttributeError, yaml.YAMLError):
        return None
    return Takeover(
        folder=folder,
        segment=segments_of(folder)[-1][0],
        tick=float(table.columns[TICK][-1]),
        time_s=float(table.columns["time_s"][-1]),
        tick_at=header.columns.index(TICK),
        events=events,
    )


def _events(path: Path) -> frozenset[EventKey]:
    """Return the events of the ring that a file holds, and cut half a row off its end."""
    with open_plain(path) as file:
        text = file.read(_LARGEST_EVENTS)
    whole = text.rfind(b"\n") + 1
    if 0 < whole < len(text):
        os.truncate(path, whole)
    rows = csv.reader(text[:whole].decode("utf-8", "replace").splitlines())
    return frozenset((row[0], row[1], row[2], row[4]) for row in rows if len(row) > 4 and row[2])
