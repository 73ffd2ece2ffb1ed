"""A part of a service's run as a record: segments joined, scans on a grid, corrections in."""

from __future__ import annotations

import hashlib
import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from aff_runtime.base.effort import bounded_effort
from aff_runtime.base.errors import AffError, PlantError
from aff_runtime.base.printable import printable
from aff_runtime.base.probe_columns import STAGE
from aff_runtime.base.run_table import SAME_CYCLE_SHARE, RunTable, few, other_line, read_table
from aff_runtime.base.run_window import run_window
from aff_runtime.base.signals import Status
from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.records.recorded_only import Filled, filled
from sim_plant.refine.records.recording import Recording, RunFacts
from sim_plant.refine.records.run_activity import Activity, activity_of
from sim_plant.refine.records.run_angle import without_starts_over
from sim_plant.refine.records.run_delivery import Delivered, delivered, on_grid, sent_unseen
from sim_plant.refine.records.run_grid import (
    Break,
    Rows,
    Scans,
    angle_breaks,
    line_breaks,
    scans_of,
)
from sim_plant.refine.records.run_heartbeat import modulus_of
from sim_plant.refine.records.run_site import DEFAULT_SPEED, RunSite, run_site
from sim_plant.refine.records.sanity import counts_seen, oddities
from sim_plant.refine.records.word_steps import counts_of

READ_TIMEOUT_S = 300.0
"""To read a run that somebody sent: thousands of segments can be small and long to read."""
MEMORY_BYTES = 4 << 30
"""Most memory for that."""
SHORTEST_PIECE_S = 20.0
"""A shorter piece is refused. Of a record as short as this the first quarter is not judged."""
NEEDED = (
    *("time_s", "tick", "periods_count", "state", "state_bits", "outcome", "fresh"),
    *("plc_heartbeat", "status", "roll_id"),
)
"""Columns without which the rows of a run cannot be put in order."""
EDITED = ("CONFIG_APPLIED", "EDIT")
"""Events by which the site file changed during a run."""
CORRECTION = "correction_"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Piece:
    """Rows of the scans from ``first`` to before ``end`` without a break in them.

    Attributes
    ----------
    from_s, to_s : times of the first and the last row, s of the run's ``time_s``.
    running : no splice passes and LINE_RUN is set there; a run in which it never is counts as one
        of a PLC that does not say so, and as running.
    """

    first: int
    end: int
    from_s: float
    to_s: float
    running: bool

    @property
    def length_s(self) -> float:
        """Duration, s."""
        return self.to_s - self.from_s

    def __str__(self) -> str:
        """Return its times in the run."""
        return f"{self.from_s:.1f}..{self.to_s:.1f} s"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ScannedRun:
    """The rows of a window of a run on the PLC's scans.

    Attributes
    ----------
    read, whole : readings by channel, as they are and without gaps.
    pieces : unbroken. ``breaks``, ``said`` : sentences, of what ends a piece and of the rest.
    """

    table: RunTable
    site: RunSite
    scans: Scans
    read: Mapping[str, Array]
    whole: Mapping[str, Filled]
    pieces: Sequence[Piece]
    breaks: Sequence[str]
    said: Sequence[str]


def scanned_run(path: Path) -> ScannedRun:
    """Return a window of a run, cut into its pieces.

    Raises
    ------
    PlantError
        It is no run, holds no rows there, or has not the columns of one.
    """
    try:
        shown = printable(str(path))
        with bounded_effort(shown, PlantError, seconds=READ_TIMEOUT_S, memory_bytes=MEMORY_BYTES):
            table = read_table(run_window(path))
    except AffError as error:
        raise PlantError(str(error)) from error
    _refuse_missing_columns(path, table.columns)
    site = run_site(table.site_text, f"{shown}: site.yaml")
    if other := other_line(table.about, site.name):
        raise PlantError(f"{shown}: {other}")
    channels = [name for name in site.count_sizes if _is_read(table.columns, name)]
    waited_for = [name for name in channels if name in site.needed]
    modulus, guessed = modulus_of(table.about, table.columns)
    try:
        scans = scans_of(table.columns, waited_for, modulus)
    except PlantError as error:
        raise PlantError(f"{shown}: {error}") from error
    read = {n: table.columns[n][scans.rows] for n in channels}
    time_s = table.columns["time_s"][scans.rows]
    site = replace(site, count_sizes=counts_of(read, site.count_sizes))
    turned, counted = without_starts_over(read, scans.taken_s, scans.step_s, site.registers_rad)
    whole = {n: filled(v, scans.taken_s, time_s, scans.step_s) for n, v in turned.items()}
    readings = {n: one.values for n, one in whole.items()}
    pieces, breaks = _pieces(table.columns, scans, readings)
    said = [
        *_other_cycle(scans.cycle_s, site.cycle_s),
        *table.lost,
        *few(_edits(table)),
        *([guessed] if guessed else []),
        *scans.findings,
        *few(breaks),
        *counted,
    ]
    return ScannedRun(
        table=table,
        site=site,
        scans=scans,
        read=read,
        whole=whole,
        pieces=pieces,
        breaks=breaks,
        said=said,
    )


def read_run_record(path: Path) -> Recording:
    """Return the longest unbroken piece of the window that ``path`` names, SI, on an even grid.

    Raises
    ------
    PlantError
        It is no run, holds no rows there, or no piece of ``SHORTEST_PIECE_S``.
    """
    found = scanned_run(path)
    table, site, scans, pieces = found.table, found.site, found.scans, found.pieces
    piece = _longest(path, pieces, [*few(table.lost), *few(found.breaks)])
    piece, acted = _with_corrections(table.columns, site, scans, piece)
    lost = {n: one.holes_in(piece.first, piece.end) for n, one in found.whole.items()}
    kept = {n: one.values for n, one in found.whole.items() if not lost[n]}
    grid = _on_grid(table.columns, site, scans, piece, kept, acted)
    said = [_unread(name, table.columns) for name in site.count_sizes if name not in found.read]
    said += [f"{n} is left out: {text}" for n, text in lost.items() if text]
    said += found.said
    if len(pieces) > 1:
        others = ", ".join(few([str(p) for p in pieces if p.end != piece.end]))
        said.append(f"taken is {piece} of the run; left out {others}")
    measured = {n: v for n, v in grid.columns.items() if not n.startswith(CORRECTION)}
    return Recording(
        path=path,
        sha256=_digest(grid.columns),
        sample_time_s=scans.step_s,
        columns=grid.columns,
        findings=(
            *said,
            *grid.said,
            *oddities(measured, counts_seen(found.read, site.count_sizes)),
        ),
        zeros_rad=grid.zeros_rad,
        run=RunFacts(
            site=site,
            activity=grid.activity,
            delivery_known=grid.delivery_known,
            scan_s=scans.scan_s,
            from_s=piece.from_s,
            to_s=piece.to_s,
            run_id=table.run_id,
            roll_id=float(table.columns["roll_id"][scans.rows[piece.first]]),
        ),
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Grid:
    """What a piece holds, on its even grid; ``zeros_rad``: what was taken off the angles.

    ``delivery_known``: by actuator, whether the record says when a correction acted.
    """

    columns: dict[str, Array]
    zeros_rad: dict[str, float]
    activity: Activity
    delivery_known: dict[str, bool]
    said: list[str]


def _other_cycle(tick_s: float, cycle_s: float) -> list[str]:
    """Return a sentence where rows come at another cycle than the site file's (0: not said)."""
    if cycle_s <= 0.0 or abs(tick_s / cycle_s - 1.0) <= SAME_CYCLE_SHARE:
        return []
    return [
        f"a tick takes {1e3 * tick_s:.4g} ms, its site.yaml says {1e3 * cycle_s:.4g} ms: is it of "
        "another run?"
    ]


def _refuse_missing_columns(path: Path, columns: Mapping[str, Array]) -> None:
    missing = [name for name in NEEDED if name not in columns]
    if missing:
        raise PlantError(
            f"{printable(str(path))}: the run has no column {', '.join(missing)}: another "
            "version of aff-runtime recorded it; give a run of this one"
        )


def _longest(path: Path, pieces: Sequence[Piece], reasons: Sequence[str]) -> Piece:
    """Return the longest piece of the running line; ``reasons`` are said where none will do."""
    piece = max((p for p in pieces if p.running), key=lambda p: p.length_s, default=None)
    if piece is None or piece.length_s < SHORTEST_PIECE_S:
        raise PlantError(
            f"{printable(str(path))}: no {SHORTEST_PIECE_S:g} s of the running line without a "
            f"break: {'; '.join(reasons) or 'the window is too short'}; give another window"
        )
    return piece


def _pieces(
    columns: Mapping[str, Array], scans: Scans, readings: Mapping[str, Array]
) -> tuple[list[Piece], list[str]]:
    """Return the unbroken pieces, and every break as a sentence with its time."""
    breaks: list[Break] = [*scans.breaks, *line_breaks(columns, scans.rows)]
    for name, values in readings.items():
        if name.endswith("_rad"):
            breaks += angle_breaks(values, scans.taken_s, name)
    rows, time_s = scans.rows, columns["time_s"]
    status = columns["status"][rows].astype(np.int64)
    runs = (status & int(Status.LINE_RUN)) != 0
    spliced = (status & int(Status.SPLICE_ACTIVE)) != 0
    edges = sorted({0, rows.size, *(b.row for b in breaks)})
    pieces = [
        Piece(
            first=first,
            end=end,
            from_s=float(time_s[rows[first]]),
            to_s=float(time_s[rows[end - 1]]),
            running=bool(runs[first] or not runs.any()) and not bool(spliced[first]),
        )
        for first, end in itertools.pairwise(edges)
        if end - first >= CRITERIA.records.fewest_rows
    ]
    by_row: dict[int, list[str]] = {}
    for b in breaks:
        by_row.setdefault(b.row, []).append(b.why)
    said = [f"at {time_s[rows[r]]:.2f} s {', '.join(by_row[r])}" for r in sorted(by_row)]
    return pieces, said


def _with_corrections(
    columns: Mapping[str, Array], site: RunSite, scans: Scans, piece: Piece
) -> tuple[Piece, dict[str, Delivered]]:
    """Return the piece from where it is known what acted, and what did.

    A correction acts some cycles after its row: the first rows of a window, or after a hole, carry
    what was decided in rows that are not there.
    """
    acted = _acted(columns, site, scans.rows[piece.first : piece.end], scans.cycle_s)
    late = max((one.unknown_first for one in acted.values()), default=0)
    if not 0 < late < piece.end - piece.first:
        return piece, acted
    first = piece.first + late
    from_s = float(columns["time_s"][scans.rows[first]])
    known = {n: replace(one, values=one.values[late:]) for n, one in acted.items()}
    return replace(piece, first=first, from_s=from_s), known


def _on_grid(
    table: Mapping[str, Array],
    site: RunSite,
    scans: Scans,
    piece: Piece,
    readings: Mapping[str, Array],
    acted: Mapping[str, Delivered],
) -> _Grid:
    """Return everything of one piece on its grid."""
    part = slice(piece.first, piece.end)
    rows, taken_s = scans.rows[part], scans.taken_s[part] - scans.taken_s[piece.first]
    grid: Array = np.arange(round(taken_s[-1] / scans.step_s) + 1) * scans.step_s
    columns = {name: np.interp(grid, taken_s, values[part]) for name, values in readings.items()}
    pace_s = max(scans.scan_s, scans.step_s)  # a scan that takes a bit longer leaves out none
    missing = round(taken_s[-1] / pace_s) + 1 - np.unique(np.rint(taken_s / pace_s)).size
    said = [f"{missing} missing samples are filled in between"] if missing > 0 else []
    # per sample of the grid, the newest row that was there
    newest = np.searchsorted(taken_s, grid + 1e-9, side="right") - 1
    unseen = sent_unseen(table, rows)
    going = {}
    for name, correction in acted.items():
        going[name] = on_grid(correction.values, taken_s, grid, scan_s=scans.scan_s, unseen=unseen)
        columns[f"{CORRECTION}{name}_{site.actuators[name].suffix}"] = going[name]
        said.append(f"corrections of {name}: {correction.how}")
    zeros = {n: float(v[0]) for n, v in columns.items() if n.endswith("_rad")}
    columns |= {name: columns[name] - zero for name, zero in zeros.items()}
    speed = columns.get(site.speed, columns.get(DEFAULT_SPEED, np.zeros(grid.size)))
    activity = activity_of(
        {n: v[rows][newest] for n, v in table.items() if _of_service(n)},
        list(going.values()),
        speed,
        scans.step_s,
    )
    return _Grid(
        columns=columns,
        zeros_rad=zeros,
        activity=activity,
        delivery_known={name: correction.known for name, correction in acted.items()},
        said=[*said, *activity.sentences()],
    )


def _is_read(columns: Mapping[str, Array], name: str) -> bool:
    """Return whether a channel is recorded and has readings in half of the rows at least."""
    return name in columns and float(np.mean(np.isfinite(columns[name]))) > 0.5


def _unread(name: str, columns: Mapping[str, Array]) -> str:
    """Return what is said of a channel of the site file without readings."""
    if name in columns:
        return f"{name} was never read"
    return f"{name}: its site.yaml maps it, the run has no such column: is it of another run?"


def _of_service(name: str) -> bool:
    return name in ("state", "state_bits", STAGE) or name.startswith("limit_ratio_")


def _acted(
    columns: Mapping[str, Array], site: RunSite, rows: Rows, cycle_s: float
) -> dict[str, Delivered]:
    """Return what acted of every actuator whose corrections are recorded."""
    return {
        name: delivered(
            columns,
            f"{name}_{a.suffix}",
            rows,
            count=a.count,
            delay_s=a.transport_s,
            cycle_s=cycle_s,
        )
        for name, a in site.actuators.items()
        if f"{CORRECTION}{name}_{a.suffix}" in columns
    }


def _edits(table: RunTable) -> list[str]:
    """Return a sentence for every change of the site file within the run's window."""
    return [
        f"at {row.get('time_s', '?')} s the site file was changed ({row.get('text', '')}): "
        "channels and units are those of the window's beginning, which no live edit changes"
        for row in table.events
        if row.get("name") in EDITED
    ]


def _digest(columns: Mapping[str, Array]) -> str:
    """Return a hash of names and values."""
    total = hashlib.sha256()
    for name in sorted(columns):
        total.update(name.encode())
        total.update(np.ascontiguousarray(columns[name]).tobytes())
    return total.hexdigest()
