"""Rows of a run folder as arrays: segments joined, what is lost of them named.

A crash leaves the last segment half written, a full disk one in the middle, and the bound on the
disk takes the oldest away. Whole rows are taken, nothing is put in the place of others.
"""

from __future__ import annotations

import csv
import io
import itertools
import json
import math
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from aff_runtime.base.errors import AffError
from aff_runtime.base.files import CLOSED_TEXT, is_closed
from aff_runtime.base.printable import printable, text_or
from aff_runtime.base.runs.files import text_of, yaml_values
from aff_runtime.base.runs.join import (
    LARGEST_NUMBER,
    LONGEST_RUN_S,
    PERIODS,
    odd_times,
    of_another_cycle,
    period_s,
    rows_once,
)
from aff_runtime.base.runs.segment import (
    LARGEST_VALUES,
    RunSegments,
    first_row,
    rows_of,
    segments_of,
)
from aff_runtime.base.runs.site_in_force import (
    SITE_SHA256,
    SiteInForce,
    changes_noted,
    in_force_within,
    sites_in_force,
    time_of,
)
from aff_runtime.base.runs.window import HOW_WRITTEN, MARK, RunWindow
from aff_runtime.base.yaml_section import Section

MOST_EVENTS = 100_000
MOST_EVENT_COLUMNS = 16
RECORDER_DIED = "RECORDER_DIED"
"""Event: another recorder goes on in the folder of one that died, and says what neither has."""
MOST_SAID = 20
"""Sentences of one kind; more of them nobody reads."""
LONGEST_NAME = 200
_LARGEST_YAML = _LARGEST_SUMMARY = 1 << 20
_LARGEST_TEXT = 64 << 20
_LOSSES = {
    "rows_lost_to_disk": "{} rows were refused by the disk",
    "files_lost_to_disk": "{} events or small files were refused by the disk",
    "segments_deleted": "{} segments were deleted to bound the disk, of this run or older ones",
    "ring_overruns": "{} rows were overwritten before the recorder had read them",
}

Columns = dict[str, NDArray[np.float64]]


@dataclass(frozen=True, slots=True, kw_only=True)
class RunTable:
    """The rows of a window.

    Attributes
    ----------
    window : what was asked for.
    about : contents of ``run.yaml``. ``run_id`` : the same for every copy of the folder.
    columns : one array (rows,) per column name, in the order of the file.
    site_text : the site file in force where the window begins; empty where it is missing.
    events : rows of ``events.csv`` within the window, those without a time among them.
    lost : sentences about what the files no longer have.
    sites : every site file in force in the window, in order; the first is ``site_text``.
    """

    window: RunWindow
    about: Section
    columns: Columns
    site_text: str
    events: tuple[dict[str, str], ...]
    lost: tuple[str, ...]
    run_id: str = ""
    sites: tuple[SiteInForce, ...] = ()

    @property
    def site_changes(self) -> list[Mapping[str, str]]:
        """Those events that tell of a change of the site file."""
        return changes_noted(self.sites, [(time_of(row), row) for row in self.events])


def read_table(
    window: RunWindow,
    keep: Callable[[str], bool] | None = None,
    segments: RunSegments | None = None,
    sites: Sequence[SiteInForce] | None = None,
) -> RunTable:
    """Return the rows of ``window``; only columns whose name ``keep`` takes, where it is given.

    ``time_s`` is always there. Of segments outside the window only the first row is unpacked, and
    none where ``segments`` says when each begins. ``sites`` : those of the run, where known.

    Raises
    ------
    AffError
        The folder is no run, the window holds no row, or more than ``LARGEST_VALUES`` numbers.
    """
    folder = window.folder
    about = _about(folder)
    names: list[str] = about.data["columns"]
    wanted = [k for k, name in enumerate(names) if keep is None or k == 0 or keep(name)]
    if segments is None:
        segments = RunSegments.looked_up(folder, len(names))
    lost = few(list(_missing(segments.numbers)))
    lost += _summary_losses(folder)
    torn: list[str] = []
    parts: dict[Path, NDArray[np.float64]] = {}
    periods_s: dict[Path, float] = {}
    at = names.index(PERIODS) if PERIODS in names else None
    held, to_s = 0, min(window.to_s, LONGEST_RUN_S)
    for path in segments.within(window.from_s, window.to_s):
        rows, said = rows_of(path, names, wanted if at is None else [*wanted, at])
        periods_s[path] = period_s(rows, None if at is None else rows[:, -1])
        rows = rows[:, : len(wanted)]
        torn += [*said, *odd_times(path, rows[:, 0])]
        inside = rows[(rows[:, 0] >= window.from_s) & (rows[:, 0] < to_s)]
        inside[~(np.abs(inside) < LARGEST_NUMBER)] = np.nan
        held += inside.size
        if held > LARGEST_VALUES:
            raise AffError(f"{window}: holds too much to be read at once; give a shorter window")
        parts[path] = inside
    if held == 0:
        why = "; ".join(few([*torn, f"{segments.span(names)}; give times of the run"]))
        raise AffError(f"{window}: holds no row; {why}")
    for path, said_of_it in of_another_cycle(parts, periods_s):
        del parts[path]
        torn.append(said_of_it)
    table, said_of_times = rows_once(parts)
    torn += said_of_times
    every, said = _events(folder / "events.csv")
    events = [row for row in every if _is_inside(row, window)]
    died = [_of_recorder(row) for row in events if row.get("name") == RECORDER_DIED]
    if sites is None:
        sites = _sites(folder, about, every, to_s)
    sites = in_force_within(sites, max(window.from_s, float(table[0, 0])), to_s)
    return RunTable(
        window=window,
        about=about,
        columns={names[k]: np.ascontiguousarray(table[:, i]) for i, k in enumerate(wanted)},
        site_text=sites[0].text,
        events=tuple(events),
        lost=(
            *lost,
            *few(torn),
            *said,
            *few(died),
            *dict.fromkeys(s.said for s in sites if s.said),
        ),
        run_id=run_id(folder),
        sites=sites,
    )


def run_sites(folder: Path) -> tuple[SiteInForce, ...]:
    """Return every site file that ran in a run.

    Raises
    ------
    AffError
        The folder is no run.
    """
    return _sites(folder, _about(folder), events_of(folder)[0], math.inf)


def _sites(
    folder: Path, about: Section, events: Sequence[Mapping[str, str]], to_s: float
) -> tuple[SiteInForce, ...]:
    """Return the site files that ran before ``to_s``."""
    return sites_in_force(
        folder,
        text_of(folder / "site.yaml", _LARGEST_YAML),
        text_or(about.get("site_hash")),
        [(time_of(row), row) for row in events],
        to_s,
        text_or(about.get(SITE_SHA256)),
    )


def run_id(folder: Path) -> str:
    """Return what names a run wherever its folder is, by its ``run.yaml``."""
    return sha256(text_of(folder / MARK, _LARGEST_YAML).encode()).hexdigest()[:16]


def other_line(about: Section, site_line: str) -> str:
    """Return a sentence where a run's site file is of another line than its ``run.yaml``."""
    by_run, by_site = (" ".join(text_or(name).split()) for name in (about.get("name"), site_line))
    if not by_run or not by_site or printable(by_run) == printable(by_site):
        return ""
    return (
        f"its site.yaml is of line {printable(by_site, 100)}, its run.yaml of "
        f"{printable(by_run, 100)}; put the site file of that run in its place"
    )


def _of_recorder(row: Mapping[str, str]) -> str:
    return f"at {printable(row.get('time_s') or '?', 20)} s {row.get('text', '')}"


def last_event_s(folder: Path, is_it: Callable[[Mapping[str, str]], bool]) -> float:
    """Return when the last event of a kind was, s of the column ``time_s``; 0 without one."""
    times = (time_of(row) for row in events_of(folder)[0] if is_it(row))
    return max((one for one in times if math.isfinite(one)), default=0.0)


def events_of(folder: Path) -> tuple[list[dict[str, str]], bool]:
    """Return all events of a run in the order of the file, and whether none was left out."""
    rows, said = _events(folder / "events.csv")
    return rows, not said


@dataclass(frozen=True, slots=True, kw_only=True)
class FirstRow:
    """The first row of one segment: by column name; ``number`` is the segment's."""

    number: int
    values: Mapping[str, float]


def first_rows(folder: Path) -> tuple[Section, tuple[FirstRow, ...]]:
    """Return ``run.yaml`` and the first row of every segment that has one: a run at a glance.

    Raises
    ------
    AffError
        The folder is no run.
    """
    about = _about(folder)
    names: list[str] = about.data["columns"]
    found = ((number, first_row(path, len(names))) for number, path in segments_of(folder))
    return about, tuple(
        FirstRow(number=number, values=dict(zip(names, row, strict=True)))
        for number, row in found
        if row
    )


def few(sentences: Sequence[str]) -> list[str]:
    """Return the first ``MOST_SAID`` sentences, and how many more there are."""
    more = len(sentences) - MOST_SAID
    said = list(sentences[:MOST_SAID])
    return [*said, f"{more} more of that kind"] if more > 0 else said


def _about(folder: Path) -> Section:
    try:
        about = yaml_values(text_of(folder / MARK, _LARGEST_YAML))
        if not isinstance(about, Mapping):
            raise AffError(no_run_text(folder))
        if "columns" not in about:
            raise ValueError(f"its {MARK} says no columns: cut off? copy it anew")
        names = about["columns"]
        if not isinstance(names, list) or not names or names[0] != "time_s":
            raise ValueError("its columns do not begin with time_s")
        if not all(isinstance(name, str) for name in names):
            raise ValueError("its columns are no texts")
        if not all(name.isprintable() and len(name) <= LONGEST_NAME for name in names):
            raise ValueError("a column's name does not print, or is too long")
        if len(set(names)) != len(names):
            raise ValueError("a column stands twice in it")
    except (TypeError, ValueError) as error:
        raise AffError(_not_a_run(folder, str(error))) from None
    return Section(dict(about))


def no_run_text(folder: Path) -> str:
    """Return what to say of a path that names no run: why not, and what was meant perhaps.

    Of one that we may not look at nobody can say that it is none.
    """
    if is_closed(folder / MARK):
        return f"{printable(str(folder))}: {CLOSED_TEXT}"
    return _not_a_run(folder, _why_none(folder))


def _not_a_run(folder: Path, why: str) -> str:
    said = printable(why, 200) or f"no {MARK}"
    return f"{printable(str(folder))}: not a run folder ({said}); name one that has {MARK}"


def _why_none(folder: Path) -> str:
    """Return why a folder has no ``run.yaml`` that can be read."""
    named, at, _ = folder.name.rpartition("@")
    if at and (folder.parent / named).is_dir():
        return HOW_WRITTEN
    if not os.path.exists(folder):  # False for a name too long for the file system too
        return "it is not there"
    if not folder.is_dir():
        return "it is a file"
    try:
        inside = list(itertools.islice(folder.iterdir(), MOST_SAID))
        runs = sorted(path.name for path in inside if (path / MARK).exists())
    except OSError as error:
        return error.strerror or "it cannot be listed"
    if runs:  # by their names in the order of time
        return f"a folder of runs, name one of them, such as {runs[-1]}"
    return f"it has no {MARK}, or an empty one"


def _missing(numbers: Sequence[int]) -> Iterator[str]:
    """Yield a sentence about every gap in the numbers of segments."""
    for before, number in itertools.pairwise((0, *numbers)):
        if number - before > 1:
            which = f"{before + 1}" if number - before == 2 else f"{before + 1} to {number - 1}"
            yield f"segment {which}: not there"


def _summary_losses(folder: Path) -> Iterator[str]:
    path = folder / "summary.json"
    if not path.exists():
        yield "no summary.json: the recorder did not end by itself, or still writes"
        return
    try:
        summary = json.loads(text_of(path, _LARGEST_SUMMARY))
        for key, text in _LOSSES.items():
            if int(summary.get(key) or 0):
                yield text.format(int(summary[key]))
    except (ValueError, TypeError, AttributeError, OverflowError, RecursionError):
        yield "summary.json cannot be read"


def _events(path: Path) -> tuple[list[dict[str, str]], list[str]]:
    """Return the events of a run, and what is to be said about their file."""
    if not path.exists():
        return [], [f"no {path.name}: what was armed, edited or alarmed then is not known"]
    found: list[dict[str, str]] = []
    reader = csv.DictReader(io.StringIO(text_of(path, _LARGEST_TEXT)))
    try:
        if len(reader.fieldnames or ()) > MOST_EVENT_COLUMNS:
            return [], [f"{path.name}: has other columns than events have; left out"]
        for row in itertools.islice(reader, MOST_EVENTS):
            found.append({str(k): printable(str(v or "")) for k, v in row.items() if k})
        more = next(reader, None) is not None
    except csv.Error:
        more = True
    return found, [f"{path.name}: cannot be read to its end"] if more else []


def _is_inside(row: Mapping[str, str], window: RunWindow) -> bool:
    """Return whether an event is of a window; one without a readable time counts as inside."""
    time_s = time_of(row)
    return not (time_s < window.from_s or time_s >= window.to_s)
