"""Refine labelled pairs and write the table; rows are kept, a stopped run goes on.

python -m benchmarks.cases [--part train|check] [--only TEXT] [--out DIR] [--docs DIR]
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from benchmarks.cases.numbers import BY_LINE, declared_in
from benchmarks.cases.report import page
from benchmarks.cases.score import Label, label_of, outcome
from benchmarks.cases.work import LIMIT_S, Pair, refine
from benchmarks.rows import read_row, write_row
from benchmarks.workers import Cluster, LostJobError, add_workers
from sim_plant.fleet.refine_command import TRIES

ROOT = Path(__file__).resolve().parents[2]
PLACES = tuple(base / "shared" / "data" / "cases" for base in (ROOT, ROOT.parent))
KEYS = ("verdict", "time_s", "error")
PARTS = ("train", "check")


def row_file(out: Path, pair: Pair) -> Path:
    """Return the file of a pair's row."""
    return out / "rows" / f"{pair.part}-{pair.name}.json"


def run(
    pairs: Mapping[Pair, Label], out: Path, workers: int, scheduler: str
) -> dict[Pair, dict[str, Any]]:
    """Return the row of every pair, from ``out`` where it is there; a lost one has none."""
    rows = {pair: read_row(row_file(out, pair), KEYS) for pair in pairs}
    todo = [pair for pair, row in rows.items() if row is None]
    if todo:
        with Cluster(
            refine, workers, scheduler=scheduler, limit_s=TRIES * LIMIT_S, tell=_say
        ) as cluster:
            for at, row in cluster.run(todo):
                if isinstance(row, LostJobError):
                    _say(f"{row}")
                    continue
                rows[todo[at]] = row
                write_row(row_file(out, todo[at]), row)
                label = pairs[todo[at]]
                said = outcome(label, row["verdict"])
                _say(f"{todo[at]} {label.kind}: {said}, {row['time_s']:.0f} s")
    return {pair: row for pair, row in rows.items() if row is not None}


def _say(text: str) -> None:
    sys.stderr.write(f"{text}\n")


def labels_of(folder: Path) -> list[Label]:
    """Return the labels of one part."""
    text = (folder / "labels.yaml").read_text(encoding="utf-8")
    return [told(folder, case) for case in yaml.safe_load(text)["cases"]]


def told(folder: Path, case: Mapping[str, Any]) -> Label:
    """Return a label of a folder, with what the line's file says where that changes a number."""
    if BY_LINE.isdisjoint(effect["effect_class"] for effect in case["effects"]):
        return label_of(case)
    text = (folder / f"{case['case']}_a.yaml").read_text(encoding="utf-8")
    return label_of(case, declared_in(yaml.safe_load(text)))


def main(arguments: Sequence[str] | None = None) -> int:
    """Run what is asked for, write the page; return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.cases", description=__doc__)
    parser.add_argument("--part", choices=PARTS, action="append", help="default: both")
    parser.add_argument("--only", default="", help="names that contain this")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "refine-cases")
    parser.add_argument("--docs", type=Path, default=None, help="also write the page here")
    add_workers(parser)
    given = parser.parse_args(arguments)
    base = next((place for place in PLACES if place.exists()), None)
    if base is None:
        print(f"no labelled pairs: looked for {' and '.join(map(str, PLACES))}")
        return 2
    out = given.out.absolute()
    pairs = {
        Pair(
            folder=base / part,
            name=label.name,
            part=part,
            out=out / "work" / f"{part}-{label.name}",
        ): label
        for part in given.part or PARTS
        for label in labels_of(base / part)
        if given.only in f"{part}-{label.name}"
    }
    rows = run(pairs, out, given.workers, given.scheduler)
    text = page([(pair.part, pairs[pair], rows[pair]) for pair in pairs if pair in rows])
    print(text)
    (out / "refine-cases.md").write_text(text, encoding="utf-8")
    if given.docs is not None:
        (given.docs / "refine-cases.md").write_text(text, encoding="utf-8")
    return 0 if len(rows) == len(pairs) else 1


if __name__ == "__main__":
    raise SystemExit(main())
