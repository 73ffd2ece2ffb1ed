"""Rows on disk: one file each, with a mark of what it came from, so that a run can be resumed."""

from __future__ import annotations

import functools
import hashlib
import json
import re
from pathlib import Path

from benchmarks.control.jobs import BenchRow, Job
from benchmarks.control.laws import ORDERS, RIVALS, TUNED
from benchmarks.control.laws import SHAPE as SHAPE_SETTING
from benchmarks.control.lines import EUCLID, FILM, ROOT
from benchmarks.rows import read_row, write_row

BENCH = ROOT / "benchmarks" / "control"
CORE = ROOT / "aff_runtime" / "core"
PLANT = ROOT / "sim_plant"
ROOMS = ("line", "elements", "effects", "geometry")
COMMON = (
    *(BENCH / f"{n}.py" for n in ("lines", "lockstep", "scores", "cases", "film", "nominal_loop")),
    *(CORE / f"{n}.py" for n in ("phase", "impulse")),
    *(p for room in ROOMS for p in (PLANT / room).glob("*.py")),
    EUCLID,
    FILM,
)
SHAPE = (
    *sorted((CORE / "shape").glob("*.py")),
    *sorted((CORE / "compiled").glob("*.[ch]")),
    CORE / "bandwidth.py",
    CORE / "gate.py",
    CORE / "params.py",
    BENCH / "laws.py",
)
OF_LAW: dict[str, tuple[Path, ...]] = {
    "plain blocks": (*sorted((CORE / "blocks").glob("*.py")), CORE / "residual.py"),
    "printed (5.14)": (BENCH / "printed.py",),
    "angle, no phase": (BENCH / "rivals_blocks.py",),
    "resonators": (BENCH / "rivals_blocks.py",),
    "FxLMS": (BENCH / "rivals_filtered.py", CORE / "shape" / "filter.py"),
    "repetitive": (BENCH / "rivals_repetitive.py",),
    "perfect roll": (),
}


@functools.cache
def _text(path: Path) -> bytes:
    return path.read_bytes()


@functools.cache
def fingerprint(law: str) -> str:
    """Return a mark that changes when the line, the judge, the law or its setting does."""
    found, params = hashlib.sha256(), SHAPE_SETTING
    for path in (*sorted(COMMON), *OF_LAW.get(law, SHAPE)):
        found.update(_text(path))
    if law in RIVALS:
        found.update(json.dumps(TUNED[law]["setting"], sort_keys=True).encode())
    elif law not in OF_LAW:
        setting = (ORDERS, params.memory_turns, params.signal_sd, params.weight_limit_m)
        found.update(repr(setting).encode())
    return found.hexdigest()[:16]


def place(folder: Path, job: Job) -> Path:
    """Return the file of a row."""
    name = re.sub(
        r"[^A-Za-z0-9.+%-]+", "_", f"{job.case.name} {job.law} {job.seed} {job.end_in:g}"
    )
    return folder / "rows" / job.section / f"{name}.json"


def load(folder: Path, job: Job) -> BenchRow | None:
    """Return the row of an earlier run, or None: none, no whole one, or its sources changed."""
    found = read_row(place(folder, job), ("from", "row"))
    if found is None or found["from"] != fingerprint(job.law):
        return None
    row: BenchRow = found["row"]
    return row


def save(folder: Path, job: Job, row: BenchRow) -> None:
    """Keep a row."""
    write_row(place(folder, job), {"from": fingerprint(job.law), "row": row})
