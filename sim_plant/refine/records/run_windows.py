"""A window of a run with breaks in it, as several windows without."""

from __future__ import annotations

from pathlib import Path

from aff_runtime.base.runs.window import run_window
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.records.run_record import scanned_run


def unbroken_windows(path: Path) -> list[Path]:
    """Return the pieces of the running line in a window as windows of their own, in their order.

    Those that are long enough for a record, the longest of them where there are too many; where
    there is none the window itself, which is then refused with its reasons.

    Raises
    ------
    PlantError
        It is no run, or holds no rows there.
    """
    run = scanned_run(path)
    shortest_s = CRITERIA.records.run.shortest_piece_s
    found = [p for p in run.pieces if p.running and p.length_s >= shortest_s]
    found = sorted(found, key=lambda p: -p.length_s)[: CRITERIA.records.most_pieces]
    past_last_s = 0.5 * run.scans.cycle_s
    folder = run_window(path).folder
    return [
        Path(f"{folder}@{p.from_s:.10g}..{p.to_s + past_last_s:.10g}")
        for p in sorted(found, key=lambda p: p.first_scan)
    ] or [path]
