"""What happens to the segments of a run, done to a copy of one."""

from __future__ import annotations

import gzip
from collections.abc import Callable, Container
from pathlib import Path

Cells = list[list[str]]


def rewrite(segment: Path, change: Callable[[list[str], Cells], None]) -> None:
    """Write a segment anew with what ``change`` does to its header and to its rows' cells."""
    head, *rows = gzip.decompress(segment.read_bytes()).decode().splitlines()
    names, cells = head.split(","), [row.split(",") for row in rows]
    change(names, cells)
    lines = [",".join(names), *(",".join(row) for row in cells), ""]
    segment.write_bytes(gzip.compress("\n".join(lines).encode(), 1))


def at_cycle(run: Path, name: str, by: float) -> None:
    """Let the rows of a segment come at another cycle, from where it begins on."""

    def change(_names: list[str], cells: Cells) -> None:
        begin_s = float(cells[0][0])
        for row in cells:
            row[0] = f"{begin_s + by * (float(row[0]) - begin_s):.10g}"

    rewrite(run / name, change)


def rename(run: Path, column: str, other: str) -> None:
    """Rename a column in run.yaml and all segments."""
    about = run / "run.yaml"
    about.write_text(about.read_text().replace(f"- {column}\n", f"- {other}\n"))

    def change(names: list[str], _cells: Cells) -> None:
        names[:] = [other if name == column else name for name in names]

    for segment in run.glob("signals-*"):
        rewrite(segment, change)


def halve_scans(run: Path) -> None:
    """Let the PLC scan in every second cycle: heartbeat and freshness of the rows say so."""

    def change(names: list[str], cells: Cells) -> None:
        beat, fresh = map(names.index, ("plc_heartbeat", "fresh"))
        for row in cells:
            counted = int(float(row[beat]))
            row[beat], row[fresh] = str(counted // 2), str(1 - counted % 2)

    for segment in run.glob("signals-*"):
        rewrite(segment, change)


def cut(run: Path, number: int, first: int, end: int) -> None:
    """Take rows out of one segment."""

    def change(_names: list[str], cells: Cells) -> None:
        del cells[first:end]

    rewrite(run / f"signals-000{number}.csv.gz", change)


def blank(run: Path, name: str, first: int, end: int) -> None:
    """Take the readings of a channel out of some rows of the first segment."""
    _blank(sorted(run.glob("signals-*"))[0], name, lambda k: first <= k < end)


def blank_some(path: Path, column: str, which: Container[int], of: int) -> None:
    """Let readings of a segment be no numbers: these of every so many rows."""
    _blank(path, column, lambda k: k % of in which)


def _blank(segment: Path, column: str, lacks: Callable[[int], bool]) -> None:
    def change(names: list[str], cells: Cells) -> None:
        at = names.index(column)
        for k, row in enumerate(cells):
            if lacks(k):
                row[at] = "nan"

    rewrite(segment, change)
