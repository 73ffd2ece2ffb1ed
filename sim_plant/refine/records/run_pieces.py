"""Pieces of a run: between two breaks, the longest that runs, and what acted on the line in it."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from aff_runtime.base.errors import PlantError
from aff_runtime.base.signals import Status
from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.records.recorded_only import Filled
from sim_plant.refine.records.run_delivery import Delivered, delivered
from sim_plant.refine.records.run_grid import Break, Rows, Scans, angle_breaks, line_breaks
from sim_plant.refine.records.run_site import RunSite

RUN = CRITERIA.records.run
CORRECTION = "correction_"
"""How the names of columns of corrections begin, before actuator and unit."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Piece:
    """The scans from ``first_scan`` to before ``end_scan``, without a break in them.

    Attributes
    ----------
    from_s, to_s : times of the first and the last one's row, s of the run's ``time_s``.
    running : no splice passes, and LINE_RUN is set; where LINE_RUN is never set in the run the PLC
        does not report it, and the line counts as running.
    """

    first_scan: int
    end_scan: int
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


def pieces_of(
    columns: Mapping[str, Array], scans: Scans, series: Mapping[str, Filled]
) -> tuple[list[Piece], list[str]]:
    """Return the unbroken pieces, and every break as a sentence with its time."""
    breaks: list[Break] = [*scans.breaks, *line_breaks(columns, scans.rows)]
    for name, one in series.items():
        if name.endswith("_rad"):
            breaks += angle_breaks(one.values, scans.taken_s, name)
    rows, time_s = scans.rows, columns["time_s"]
    status = columns["status"][rows].astype(np.int64)
    runs = (status & int(Status.LINE_RUN)) != 0
    spliced = (status & int(Status.SPLICE_ACTIVE)) != 0
    edges = sorted({0, rows.size, *(b.scan for b in breaks)})
    pieces = [
        Piece(
            first_scan=first,
            end_scan=end,
            from_s=float(time_s[rows[first]]),
            to_s=float(time_s[rows[end - 1]]),
            running=bool(runs[first] or not runs.any()) and not bool(spliced[first]),
        )
        for first, end in itertools.pairwise(edges)
        # what lies between two breaks so close is too short for any use: its breaks are told
        if end - first >= CRITERIA.records.fewest_rows
    ]
    reasons: dict[int, list[str]] = {}
    for b in breaks:
        reasons.setdefault(b.scan, []).append(b.why)
    said = [f"at {time_s[rows[k]]:.2f} s {', '.join(reasons[k])}" for k in sorted(reasons)]
    return pieces, said


def longest(window: str, pieces: Sequence[Piece], reasons: Sequence[str]) -> Piece:
    """Return the longest piece of the running line.

    Where none will do, the error names the ``window`` and the ``reasons``.
    """
    piece = max((p for p in pieces if p.running), key=lambda p: p.length_s, default=None)
    if piece is None or piece.length_s < RUN.shortest_piece_s:
        raise PlantError(
            f"{window}: no {RUN.shortest_piece_s:g} s of the running line without a break, "
            f"{'none' if piece is None else f'{piece.length_s:.3g} s at most'}: "
            f"{'; '.join(reasons) or 'the window is too short'}; give another window"
        )
    return piece


def with_corrections(
    window: str, columns: Mapping[str, Array], site: RunSite, scans: Scans, piece: Piece
) -> tuple[Piece, dict[str, Delivered]]:
    """Return the piece from where it is known what acted, and what did.

    A correction acts some cycles after its row: the first scans of a window, or after a hole,
    carry what was decided in rows that are not there.
    """
    rows = scans.rows[piece.first_scan : piece.end_scan]
    acted = _acted(columns, site, rows, scans.cycle_s)
    unknown = max((one.unknown_first for one in acted.values()), default=0)
    from_s = float(columns["time_s"][rows[min(unknown, rows.size - 1)]])
    if from_s > piece.from_s and piece.to_s - from_s < RUN.shortest_piece_s - RUN.most_unknown_s:
        raise PlantError(
            f"{window}: in {piece} it is not known until {from_s:.1f} s which correction acted, "
            f"and no {RUN.shortest_piece_s:g} s are left; give a longer window, or check "
            "transport_ms of the site file and the PLC's echo"
        )
    from_there = {n: replace(one, values=one.values[unknown:]) for n, one in acted.items()}
    return replace(piece, first_scan=piece.first_scan + unknown, from_s=from_s), from_there


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
