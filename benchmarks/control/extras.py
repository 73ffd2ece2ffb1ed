"""What is no row on the simulated line: cost of a tick, memory, rows over the wire, run times."""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np

from benchmarks.control.jobs import BenchRow
from benchmarks.control.laws import OWN
from benchmarks.rows import read_rows, write_row

PARTS = ("timing", "memory", "wire")


def _place(folder: Path, name: str) -> Path:
    return folder / f"{name}.json"


def timing(ticks: int = 3000) -> list[BenchRow]:
    """Return p50 and p99 of one tick, paced at 5 ms, us: the shape law and the plain blocks."""
    from benchmarks.control.timing import LAWS, tick_times_us

    found = []
    for name, build in LAWS.items():
        times = tick_times_us(build(), ticks)
        found.append(
            {
                "section": "timing",
                "case": name,
                "law": name,
                "at": time.strftime("%Y-%m-%d"),
                "p50_us": float(np.percentile(times, 50)),
                "p99_us": float(np.percentile(times, 99)),
            }
        )
    return found


def run_asked(given: argparse.Namespace, folder: Path) -> None:
    """Run the parts that the command line asked for, and keep what they found."""
    if given.timing:
        write_row(_place(folder, "timing"), timing())
    if given.memory > 0.0:
        from benchmarks.control.memory import watch_memory

        found = [{"law": OWN, **watch_memory(60.0 * given.memory)}]
        write_row(_place(folder, "memory"), found)
    if given.wire:
        from benchmarks.control.wire import over_the_wire

        write_row(_place(folder, "wire"), over_the_wire(folder))


def note_run(folder: Path, rows: int, took_s: float, cpu_s: float) -> None:
    """Add a line to the list of runs."""
    path = _place(folder, "runs")
    found = read_rows(path)
    found.append({"rows": rows, "took_s": took_s, "cpu_s": cpu_s, "at": time.strftime("%H:%M")})
    write_row(path, found)


def rows(folder: Path) -> list[BenchRow]:
    """Return the rows of every part that has been run."""
    found: list[BenchRow] = []
    for name in PARTS:
        found += [{"section": name, **row} for row in read_rows(_place(folder, name))]
    for row in found:
        if row["section"] == "wire":
            from benchmarks.control.wire import lockstep

            row.update(lockstep(folder, row["case"]))
    return found
