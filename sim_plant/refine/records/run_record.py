"""A part of a service's run as a record: segments joined, scans on a grid, corrections in."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from aff_runtime.base.effort import bounded_effort
from aff_runtime.base.errors import AffError, PlantError
from aff_runtime.base.printable import printable
from aff_runtime.base.probe_columns import STAGE
from aff_runtime.base.runs.counted_angle import early_wrap
from aff_runtime.base.runs.holes import BRIDGED_SHARE
from aff_runtime.base.runs.join import SAME_CYCLE_SHARE
from aff_runtime.base.runs.site_in_force import change_words
from aff_runtime.base.runs.table import RunTable, few, other_line, read_table
from aff_runtime.base.runs.window import not_recorded, run_window
from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.records.recorded_only import Filled, filled
from sim_plant.refine.records.recording import Recording, RunFacts
from sim_plant.refine.records.run_activity import Activity, activity_of
from sim_plant.refine.records.run_angle import without_starts_over
from sim_plant.refine.records.run_delivery import Delivered, on_grid, sent_unseen
from sim_plant.refine.records.run_grid import Scans, scans_of
from sim_plant.refine.records.run_heartbeat import modulus_of
from sim_plant.refine.records.run_pieces import (
    CORRECTION,
    Piece,
    longest,
    pieces_of,
    with_corrections,
)
from sim_plant.refine.records.run_site import DEFAULT_SPEED, RunSite, run_site
from sim_plant.refine.records.sanity import count_sizes_seen, oddities
from sim_plant.refine.records.word_steps import counts_of

READ_TIMEOUT_S = 300.0
"""To read a run that somebody sent: thousands of segments can be small and long to read."""
MEMORY_BYTES = 4 << 30
"""Most memory for that."""
NEEDED = (
    *("time_s", "tick", "periods_count", "state", "state_bits", "outcome", "fresh"),
    *("plc_heartbeat", "status", "roll_id"),
)
"""Columns without which the rows of a run cannot be put in order."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ScannedRun:
    """The rows of a window of a run on the PLC's scans.

    Attributes
    ----------
    readings, series : by channel, as they are and without gaps.
    pieces : unbroken. ``breaks``, ``said`` : sentences, of what ends a piece and of the rest.
    """

    table: RunTable
    site: RunSite
    scans: Scans
    readings: Mapping[str, Array]
    series: Mapping[str, Filled]
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
    shown = printable(str(path))
    table = _table(path, shown)
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
    readings = {name: table.columns[name][scans.rows] for name in channels}
    early_wraps = few([*_early_wraps(table.columns["time_s"][scans.rows], readings, site)])
    site = replace(site, count_sizes=counts_of(readings, site.count_sizes))
    series, unwrapped = _in_every_scan(table.columns["time_s"], site, scans, readings)
    pieces, breaks = pieces_of(table.columns, scans, series)
    said = [
        *_other_cycle(scans.cycle_s, site.cycle_s),
        *table.lost,
        *not_recorded(table.window, *map(float, table.columns["time_s"][[0, -1]])),
        *_unknown_roll(table.columns["roll_id"][scans.rows]),
        *few(_edits(table)),
        *([guessed] if guessed else []),
        *scans.findings,
        *few(breaks),
        *early_wraps,
        *unwrapped,
    ]
    return ScannedRun(
        table=table,
        site=site,
        scans=scans,
        readings=readings,
        series=series,
        pieces=pieces,
        breaks=breaks,
        said=said,
    )


def read_run_record(path: Path) -> Recording:
    """Return the longest unbroken piece of the window that ``path`` names, SI, on an even grid.

    Raises
    ------
    PlantError
        It is no run, holds no rows there, or no piece of ``shortest_piece_s`` (`RunCriteria`).
    """
    shown = printable(str(path))
    found = scanned_run(path)
    table, site, scans = found.table, found.site, found.scans
    piece = longest(shown, found.pieces, [*few(table.lost), *few(found.breaks)])
    piece, acted = with_corrections(shown, table.columns, site, scans, piece)
    holes = {n: one.holes_in(piece.first_scan, piece.end_scan) for n, one in found.series.items()}
    whole = {name: one.values for name, one in found.series.items() if not holes[name]}
    grid = _piece_on_grid(table.columns, site, scans, piece, whole, acted)
    measured = {n: v for n, v in grid.columns.items() if not n.startswith(CORRECTION)}
    return Recording(
        path=path,
        sha256=_digest(grid.columns),
        sample_time_s=scans.step_s,
        columns=grid.columns,
        findings=(
            *(_unread(n, table.columns) for n in site.count_sizes if n not in found.readings),
            *(f"{name} is left out: {text}" for name, text in holes.items() if text),
            *found.said,
            *_other_pieces(piece, found.pieces),
            *grid.said,
            *few([*_bridged(whole, found.series, piece)]),
            *oddities(measured, count_sizes_seen(found.readings, site.count_sizes)),
        ),
        zeros_rad=grid.zeros_rad,
        run=RunFacts(
            site=site,
            activity=grid.activity,
            delivery_known={name: one.known for name, one in acted.items()},
            scan_s=scans.scan_s,
            from_s=piece.from_s,
            to_s=piece.to_s,
            run_id=table.run_id,
            roll_id=float(table.columns["roll_id"][scans.rows[piece.first_scan]]),
        ),
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Grid:
    """What a piece holds, on its even grid; ``zeros_rad``: what was taken off the angles."""

    columns: dict[str, Array]
    zeros_rad: dict[str, float]
    activity: Activity
    said: list[str]


def _table(path: Path, shown: str) -> RunTable:
    """Return the rows of the window, with every column that is needed."""
    try:
        with bounded_effort(shown, PlantError, seconds=READ_TIMEOUT_S, memory_bytes=MEMORY_BYTES):
            table = read_table(run_window(path))
    except AffError as error:
        raise PlantError(str(error)) from error
    missing = [name for name in NEEDED if name not in table.columns]
    if missing:
        raise PlantError(
            f"{shown}: the run has no column {', '.join(missing)}: another "
            "version of aff-runtime recorded it; give a run of this one"
        )
    return table


def _in_every_scan(
    time_s: Array, site: RunSite, scans: Scans, readings: Mapping[str, Array]
) -> tuple[dict[str, Filled], list[str]]:
    """Return readings (scans,) without a gap and without starts over of angles, and remarks."""
    turned, said = without_starts_over(readings, scans.taken_s, scans.step_s, site.registers_rad)
    row_s = time_s[scans.rows]
    return {n: filled(v, scans.taken_s, row_s, scans.step_s) for n, v in turned.items()}, said


def _early_wraps(time_s: Array, readings: Mapping[str, Array], site: RunSite) -> Iterator[str]:
    """Yield a sentence per count that starts over earlier than its site file says."""
    for name, register_rad in site.registers_rad.items():
        found = early_wrap(time_s, readings[name], register_rad) if name in readings else None
        if found is not None and site.count_sizes[name] > 0.0:
            counts = round(register_rad / site.count_sizes[name])
            yield f"{printable(name, 80)}: {found.words(register_rad, counts)}"


def _other_pieces(piece: Piece, pieces: Sequence[Piece]) -> list[str]:
    """Return a sentence on what is taken and what is left out, where there is more than one."""
    # by their ends: where the one taken begins has moved where its first corrections are not known
    others = few([str(one) for one in pieces if one.end_scan != piece.end_scan])
    return [f"taken is {piece} of the run; left out {', '.join(others)}"] if others else []


def _other_cycle(tick_s: float, cycle_s: float) -> list[str]:
    """Return a sentence where rows come at another cycle than the site file's (0: not said)."""
    if cycle_s <= 0.0 or abs(tick_s / cycle_s - 1.0) <= SAME_CYCLE_SHARE:
        return []
    return [
        f"a tick takes {1e3 * tick_s:.4g} ms, its site.yaml says {1e3 * cycle_s:.4g} ms: is it of "
        "another run?"
    ]


def _unknown_roll(roll_id: Array) -> list[str]:
    """Return a sentence where the roll of web is not known in every scan."""
    absent = int(np.sum(~np.isfinite(roll_id)))
    if not absent:
        return []
    return [f"roll_id is no number in {absent} rows: another roll is not told there"]


def _piece_on_grid(
    columns: Mapping[str, Array],
    site: RunSite,
    scans: Scans,
    piece: Piece,
    readings: Mapping[str, Array],
    acted: Mapping[str, Delivered],
) -> _Grid:
    """Return everything of one piece on its grid.

    ``columns`` of the table, ``readings`` in all scans, ``acted`` in those of the piece.
    """
    part = slice(piece.first_scan, piece.end_scan)
    rows, taken_s = scans.rows[part], scans.taken_s[part] - scans.taken_s[piece.first_scan]
    grid_s: Array = np.arange(round(taken_s[-1] / scans.step_s) + 1) * scans.step_s
    gridded = {name: np.interp(grid_s, taken_s, values[part]) for name, values in readings.items()}
    zeros = {n: float(v[0]) for n, v in gridded.items() if n.endswith("_rad")}
    gridded |= {name: gridded[name] - zero for name, zero in zeros.items()}
    said = _missing_samples(taken_s, max(scans.scan_s, scans.step_s))
    unseen = sent_unseen(columns, rows)
    corrections = {}
    for name, correction in acted.items():
        corrections[f"{CORRECTION}{name}_{site.actuators[name].suffix}"] = on_grid(
            correction.values, taken_s, grid_s, scan_s=scans.scan_s, unseen=unseen
        )
        said.append(f"corrections of {name}: {correction.how}")
    speed = gridded.get(site.speed, gridded.get(DEFAULT_SPEED))
    if speed is None:
        said.append("no line speed is recorded: ramps of it are not looked for")
    # per sample of the grid, the newest row that was there
    newest = np.searchsorted(taken_s, grid_s + 1e-9, side="right") - 1
    activity = activity_of(
        {n: v[rows][newest] for n, v in columns.items() if _of_service(n)},
        list(corrections.values()),
        np.zeros(grid_s.size) if speed is None else speed,
        scans.step_s,
    )
    return _Grid(
        columns=gridded | corrections,
        zeros_rad=zeros,
        activity=activity,
        said=[*said, *activity.sentences()],
    )


def _missing_samples(taken_s: Array, pace_s: float) -> list[str]:
    """Return a sentence on how many samples no scan gave; ``pace_s`` from one to the next.

    Scans are counted by the sample that they are closest to: one that comes a bit late leaves out
    none.
    """
    wanted = round(taken_s[-1] / pace_s) + 1
    missing = wanted - np.unique(np.rint(taken_s / pace_s)).size
    return [f"{missing} missing samples are filled in between"] if missing > 0 else []


def _bridged(names: Iterable[str], series: Mapping[str, Filled], piece: Piece) -> Iterator[str]:
    """Yield a sentence per channel of which many readings lack in a piece."""
    for name in names:
        share = series[name].share_lacking(piece.first_scan, piece.end_scan)
        if share > BRIDGED_SHARE:
            yield (
                f"{printable(name, 80)}: {100.0 * share:.0f} % of its readings are no numbers and "
                "bridged between their neighbours"
            )


def _is_read(columns: Mapping[str, Array], name: str) -> bool:
    """Return whether a channel is recorded and has readings in more than half of the rows."""
    return name in columns and _read_share(columns[name]) > CRITERIA.records.run.least_read_share


def _read_share(values: Array) -> float:
    return float(np.mean(np.isfinite(values)))


def _unread(name: str, columns: Mapping[str, Array]) -> str:
    """Return what is said of a channel of the site file that has too few readings, or none."""
    if name in columns:
        share = _read_share(columns[name])
        said = f"read in {100.0 * share:.3g} % of the rows only" if share > 0.0 else "never read"
        return f"{name} is left out: {said}"
    return f"{name}: its site.yaml maps it, the run has no such column: is it of another run?"


def _of_service(name: str) -> bool:
    return name in ("state", "state_bits", STAGE) or name.startswith("limit_ratio_")


def _edits(table: RunTable) -> list[str]:
    """Return a sentence for every change of what ran within the run's window."""
    said = [
        f"at {row.get('time_s', '?')} s {change_words(row)} ({row.get('text', '')}): "
        "channels and units are those of the window's beginning, which no live edit changes"
        for row in table.site_changes
    ]
    return said + [
        f"from {one.from_s:.1f} s on the run has a site file {differs}: no live edit does that, "
        "it is of another run; what is read is as at the window's beginning"
        for one in table.sites[1:]
        if (differs := _of_other_channels(table.site_text, one.text))
    ]


def _of_other_channels(began: str, later: str) -> str:
    """Return how a later site file differs in what only a start can change; nothing where not."""
    first = run_site(began, "")
    try:
        other = run_site(later, "")
    except PlantError:
        return "that cannot be read"
    if other.name != first.name:
        return f"of line {other.name}"
    pairs = {*first.count_sizes.items()} ^ {*other.count_sizes.items()}
    names = sorted({printable(name, 40) for name, _ in pairs})
    return f"with other channels ({', '.join(names[:5])})" if names else ""


def _digest(columns: Mapping[str, Array]) -> str:
    """Return a hash of names and values."""
    total = hashlib.sha256()
    for name in sorted(columns):
        total.update(name.encode())
        total.update(np.ascontiguousarray(columns[name]).tobytes())
    return total.hexdigest()
