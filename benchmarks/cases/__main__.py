"""Refine labelled pairs and write the table; rows are kept, a stopped run goes on.

python -m benchmarks.cases [--part train|check] [--only TEXT] [--out DIR] [--docs DIR]
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import yaml

from aff_runtime.base.python_child import module_command
from benchmarks.cases.report import page
from benchmarks.cases.score import Label, label_of, outcome
from benchmarks.rows import read_row, write_row

ROOT = Path(__file__).resolve().parents[2]
PLACES = tuple(base / "shared" / "data" / "cases" for base in (ROOT, ROOT.parent))
LIMIT_S = 1800.0
TRIES = 3
"""Of a run that is killed, as by the kernel when memory is short: that says nothing of refine."""
PARTS = ("train", "check")


def refine(folder: Path, name: str, out: Path) -> dict[str, Any]:
    """Run the product's command line on one pair; return verdict, time and what went wrong."""
    command = [
        *(*module_command("sim_plant.cli.main"), "refine"),
        *(str(folder / f"{name}_a.yaml"), str(folder / f"{name}_a.csv.gz")),
        *("--holdout", str(folder / f"{name}_b.csv.gz"), "--out", str(out), "--workers", "1"),
    ]
    begun = time.monotonic()  # noqa: TID251
    try:
        for _ in range(TRIES):
            done = subprocess.run(
                command, capture_output=True, text=True, timeout=LIMIT_S, check=False
            )
            if done.returncode >= 0:
                break
            sys.stderr.write(f"{name}: ended by signal {-done.returncode}\n")
        error = "" if done.returncode == 0 else done.stderr[-400:] or f"exit {done.returncode}"
    except subprocess.TimeoutExpired:
        error = f"longer than {LIMIT_S:.0f} s"
    path = out / "verdict.json"
    verdict = json.loads(path.read_text(encoding="utf-8")) if path.exists() and not error else {}
    spent_s = time.monotonic() - begun  # noqa: TID251
    return {"verdict": verdict, "time_s": spent_s, "error": error}


def row_of(folder: Path, label: Label, part: str, out: Path) -> dict[str, Any]:
    """Return the row of one pair, from ``out`` when it is there."""
    place = out / "rows" / f"{part}-{label.name}.json"
    kept = read_row(place, ("verdict", "time_s", "error"))
    if kept is not None:
        return kept
    row = refine(folder, label.name, out / "work" / f"{part}-{label.name}")
    write_row(place, row)
    said = outcome(label, row["verdict"])
    sys.stderr.write(f"{part} {label.name} {label.kind}: {said}, {row['time_s']:.0f} s\n")
    return row


def labels_of(folder: Path) -> list[Label]:
    """Return the labels of one part."""
    text = (folder / "labels.yaml").read_text(encoding="utf-8")
    return [label_of(case) for case in yaml.safe_load(text)["cases"]]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run what is asked for, write the page; return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.cases", description=__doc__)
    parser.add_argument("--part", choices=PARTS, action="append", help="default: both")
    parser.add_argument("--only", default="", help="names that contain this")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "refine-cases")
    parser.add_argument("--docs", type=Path, default=None, help="also write the page here")
    given = parser.parse_args(arguments)
    base = next((place for place in PLACES if place.exists()), None)
    if base is None:
        print(f"no labelled pairs: looked for {' and '.join(map(str, PLACES))}")
        return 2
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "NUMBA_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    jobs = [
        (base / part, label, part)
        for part in given.part or PARTS
        for label in labels_of(base / part)
        if given.only in f"{part}-{label.name}"
    ]
    with ThreadPoolExecutor(given.workers) as pool:
        rows = list(pool.map(lambda job: row_of(job[0], job[1], job[2], given.out), jobs))
    text = page([(part, label, row) for (_, label, part), row in zip(jobs, rows, strict=True)])
    print(text)
    (given.out / "refine-cases.md").write_text(text, encoding="utf-8")
    if given.docs is not None:
        (given.docs / "refine-cases.md").write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
