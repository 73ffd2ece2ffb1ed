"""What is no row on the simulated line: cost of a tick, memory, rows over the wire, run times."""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.control.jobs import Row
from benchmarks.control.laws import OWN

PARTS = ("timing", "memory", "wire")


def _write(folder: Path, name: str, found: Any) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.json").write_text(json.dumps(found, indent=1))


def timing(ticks: int = 3000) -> list[Row]:
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
        _write(folder, "timing", timing())
    if given.memory > 0.0:
        from benchmarks.control.memory import watch_memory

        _write(folder, "memory", [{"law": OWN, **watch_memory(60.0 * given.memory)}])
    if given.wire:
        from benchmarks.control.wire import over_the_wire

        _write(folder, "wire", over_the_wire(folder))


def note_run(folder: Path, rows: int, took_s: float, cpu_s: float) -> None:
    """Add a line to the list of runs."""
    path = folder / "runs.json"
    found = json.loads(path.read_text()) if path.exists() else []
    found.append({"rows": rows, "took_s": took_s, "cpu_s": cpu_s, "at": time.strftime("%H:%M")})
    _write(folder, "runs", found)


def rows(folder: Path) -> list[Row]:
    """Return the rows of every part that has been run."""
    found: list[Row] = []
    for name in PARTS:
        path = folder / f"{name}.json"
        if path.exists():
            found += [{"section": name, **row} for row in json.loads(path.read_text())]
    for row in found:
        if row["section"] == "wire":
            from benchmarks.control.wire import lockstep

            row.update(lockstep(folder, row["case"]))
    return found
