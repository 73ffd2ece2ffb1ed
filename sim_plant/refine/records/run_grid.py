"""Rows of a run on an even grid: the PLC's own scans, holes named, breaks found.

A row belongs to the scan whose readings it shows. The PLC's heartbeat counts its scans, so it says
which one that is, however late the row was made; a row without a new heartbeat shows nothing new.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from aff_runtime.base.errors import PlantError
from aff_runtime.base.runs.roll_changes import roll_changes
from aff_runtime.base.signals import Outcome, Status
from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.records.run_heartbeat import HEARTBEAT_COUNTS, scans_between

RUN = CRITERIA.records.run
LONGEST_HOLE_STEPS = RUN.filled_samples + RUN.beyond_filled
"""From one reading to the next, with half a step for stamps that wander. A longer hole ends a
piece; of a channel for the record alone it drops the channel."""
ALWAYS_NEEDED = ("tick", "periods_count", "plc_heartbeat", "status")
"""Columns without which a row shows nothing, beside the channels that are asked for."""

Flags = npt.NDArray[np.bool_]
Rows = npt.NDArray[np.intp]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Break:
    """Where no record may go on: the index of the first scan after it, and why."""

    scan: int
    why: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Scans:
    """The rows of a run that show new readings, and when these were taken.

    Attributes
    ----------
    rows : which row of the table shows each scan (scans,).
    taken_s : when each scan was taken, s since the first, on the PLC's own clock (scans,).
    step_s : of the even grid for a record: the PLC's period or the run's cycle, whichever is
        longer; whole cycles where the period is within ``near_period_share`` of as many.
    scan_s, cycle_s : period of the PLC's scans, and of the service's ticks.
    breaks : in order.
    findings : sentences.
    """

    rows: Rows
    taken_s: Array
    step_s: float
    scan_s: float
    cycle_s: float
    breaks: tuple[Break, ...]
    findings: tuple[str, ...]


def scans_of(
    columns: Mapping[str, Array], channels: Sequence[str], modulus: float = HEARTBEAT_COUNTS
) -> Scans:
    """Return the scans in the rows of a run; in each of them every one of ``channels`` was read.

    ``modulus`` : counts after which the heartbeat starts over.

    Raises
    ------
    PlantError
        No row shows anything new; the times of the rows do not go on, or hardly; or no two rows
        within ``late_s`` have a heartbeat that moves by fewer than ``most_scans``.
    """
    time_s, good = columns["time_s"], (columns["outcome"] == Outcome.OK) & (columns["fresh"] > 0)
    unread = np.zeros(time_s.shape, dtype=np.bool_)
    for name in (*channels, *ALWAYS_NEEDED):
        unread |= ~(np.abs(columns[name]) < RUN.largest_count)
    good &= ~unread
    rows = np.flatnonzero(good)
    if rows.size < 3:
        unreadable = _unreadable(columns, channels)
        raise PlantError(f"no row shows new readings of the PLC{unreadable}; give another window")
    cycle_s = _cycle_s(columns)
    time_s, beat = time_s[rows], columns["plc_heartbeat"][rows]
    elapsed_s = np.diff(time_s)
    by_counter, moved = scans_between(beat, elapsed_s, modulus)
    scan_s, unsure = _scan_s(elapsed_s, by_counter)
    back = np.flatnonzero(elapsed_s <= 0.0)
    breaks = {int(k) + 1: "the clock of the run goes back" for k in back}
    ticks_s = np.diff(columns["tick"][rows]) * cycle_s
    for k in np.flatnonzero(np.abs(moved * scan_s - elapsed_s) > RUN.late_s):
        why = "the PLC's heartbeat jumps: it started anew, or stood still"
        if elapsed_s[k] - max(ticks_s[k], moved[k] * scan_s) > RUN.late_s:
            why = f"the clock of the run jumps {elapsed_s[k]:.3g} s ahead, and neither ticks nor "
            why += "the PLC's heartbeat do: it was set, or the machine stood still"
        breaks.setdefault(int(k) + 1, why)
    for scan in breaks:  # the heartbeat does not tell how many scans lie there: the clock has to
        moved[scan - 1] = max(1.0, round(float(elapsed_s[scan - 1]) / scan_s))
    said = _losses(columns, good)
    whole_s = max(1, round(scan_s / cycle_s)) * cycle_s
    off = abs(scan_s / whole_s - 1.0)
    step_s = whole_s if off < RUN.near_period_share else max(scan_s, cycle_s)
    if off < max(RUN.same_period_share, min(unsure, RUN.near_period_share)):
        scan_s = whole_s
    if step_s != scan_s:
        said.append(
            f"the PLC scans every {1e3 * scan_s:.4g} ms: put on the run's cycle"
            + (f" times {round(step_s / cycle_s)}" if step_s > 1.5 * cycle_s else "")
        )
    elif scan_s > cycle_s:
        said.append(f"the PLC scans every {1e3 * scan_s:.4g} ms: one sample a scan")
    taken_s: Array = np.concatenate(([0.0], np.cumsum(moved))) * scan_s
    intervals_s = np.diff(taken_s)
    for k in np.flatnonzero(intervals_s / step_s > LONGEST_HOLE_STEPS):
        breaks.setdefault(int(k) + 1, f"nothing was read for {intervals_s[k]:.3g} s")
    return Scans(
        rows=rows,
        taken_s=taken_s,
        step_s=step_s,
        scan_s=scan_s,
        cycle_s=cycle_s,
        breaks=tuple(Break(scan=k, why=breaks[k]) for k in sorted(breaks)),
        findings=tuple(said),
    )


def _unreadable(columns: Mapping[str, Array], channels: Sequence[str]) -> str:
    """Return the columns for want of which no row can be used, in brackets; nothing of none."""
    names = dict.fromkeys((*ALWAYS_NEEDED, "outcome", "fresh", *channels))
    never = [name for name in names if not np.any(np.abs(columns[name]) < RUN.largest_count)]
    return f" ({', '.join(never)}: no number in any of them)" if never else ""


def _cycle_s(columns: Mapping[str, Array]) -> float:
    """Return the run's cycle, s: time from row to row over the periods between them."""
    elapsed_s, periods = np.diff(columns["time_s"]), columns["periods_count"][1:]
    usable = (elapsed_s > 0.0) & (periods > 0.0)
    if not usable.any():
        raise PlantError("the times of the rows do not go on; give another window")
    return _long_enough(float(np.median(elapsed_s[usable] / periods[usable])))


def _scan_s(elapsed_s: Array, moved: Array) -> tuple[float, float]:
    """Return the period of the PLC's scan, s: time over counts, where both go on as usual.

    And how far it may be off, as a share of it. Of each uninterrupted sequence of usual rows the
    time from first to last is off by a scan and a tick at most: a row may show a scan that ended
    up to a scan ago, and may come up to a tick late.
    """
    usual = (elapsed_s > 0.0) & (elapsed_s < RUN.late_s) & (moved > 0.0) & (moved < RUN.most_scans)
    if not usual.any():
        raise PlantError(
            f"no two rows within {RUN.late_s:g} s have a heartbeat that moves; give another window"
        )
    span_s = float(np.sum(elapsed_s[usual]))
    scan_s = _long_enough(span_s / float(np.sum(moved[usual])))
    sequences = 1 + np.count_nonzero(usual[1:] & ~usual[:-1])
    return scan_s, sequences * (scan_s + float(np.median(elapsed_s[usual]))) / span_s


def _long_enough(period_s: float) -> float:
    """Return the period; PlantError when it is too short for one."""
    if period_s < RUN.shortest_period_s:
        raise PlantError("the times of the rows hardly go on; give another window")
    return period_s


def _losses(columns: Mapping[str, Array], good: Flags) -> list[str]:
    """Return sentences about ticks that were late, failed or showed nothing new."""
    said = []
    missed = int(np.sum(_beyond_one(columns["periods_count"][1:])))
    if missed:
        said.append(f"{missed} ticks were missed")
    with np.errstate(invalid="ignore", over="ignore"):
        absent = int(np.sum(_beyond_one(np.diff(columns["tick"]))))
    if absent:
        said.append(f"{absent} rows are missing between those that are there")
    failed = int(np.sum(columns["outcome"] != Outcome.OK))
    if failed:
        said.append(f"{failed} exchanges with the PLC failed")
    stale = int(np.sum(~good)) - failed
    if stale:
        said.append(f"{stale} rows show nothing new of the PLC, or a reading is missing in them")
    return said


def _beyond_one(steps: Array) -> Array:
    """Return by how much each step is more than one; 0 where it is no count."""
    return np.where(np.abs(steps) < RUN.largest_count, np.maximum(steps - 1.0, 0.0), 0.0)


def line_breaks(columns: Mapping[str, Array], rows: Rows) -> list[Break]:
    """Return where a splice begins or ends, the roll, LINE_RUN or WEB_INTACT changes."""
    status = columns["status"][rows].astype(np.int64)
    breaks = []
    spliced = (status & int(Status.SPLICE_ACTIVE)) != 0
    for k in np.flatnonzero(np.diff(spliced.astype(np.int8))) + 1:
        breaks.append(Break(scan=int(k), why="a splice begins" if spliced[k] else "a splice ends"))
    for k in np.flatnonzero(roll_changes(columns["roll_id"][rows])):
        breaks.append(Break(scan=int(k), why="another roll is on"))
    for bit, name in ((Status.LINE_RUN, "LINE_RUN"), (Status.WEB_INTACT, "WEB_INTACT")):
        on = (status & int(bit)) != 0
        for k in np.flatnonzero(np.diff(on.astype(np.int8))) + 1:
            breaks.append(Break(scan=int(k), why=f"{name} {'comes' if on[k] else 'goes'}"))
    return breaks


def angle_breaks(values: Array, taken_s: Array, name: str) -> list[Break]:
    """Return where an angle (scans,) jumps by more than the roll can have turned: a new count."""
    steps, elapsed_s = np.diff(values), np.diff(taken_s)
    rate = steps / np.maximum(elapsed_s, 1e-9)
    usual = float(np.median(rate))
    odd = np.abs(steps - usual * elapsed_s) > np.pi + 2.0 * abs(usual) * elapsed_s
    return [Break(scan=int(k) + 1, why=f"{name} counts anew") for k in np.flatnonzero(odd)]
