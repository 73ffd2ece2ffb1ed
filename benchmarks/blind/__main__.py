"""Draw labelled pairs of this simulator, refine and judge them; a stopped run goes on.

python -m benchmarks.blind --cases N --seed S --out DIR [--changed]
                          [--draw-only] [--only TEXT]
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import yaml

from benchmarks.blind.cases import Case, changed, drawn, make
from benchmarks.cases.__main__ import KEYS, row_file, told
from benchmarks.cases.report import tables
from benchmarks.cases.score import Label, named_sets, outcome, over_floor
from benchmarks.cases.work import Pair, refine
from benchmarks.rows import read_row, write_row

RESULTS = "results.txt"
HEAD = """# Pairs that a second simulator drew

Repeat: `python -m benchmarks.blind --cases {cases} --seed {seed} --out DIR`; a stopped run goes
on. That simulator shares no code with `sim_plant`; no rule of the search was set on these pairs.

"""


def draw(cases: Sequence[Case], out: Path) -> None:
    """Make the cases that are not there yet; ``labels.yaml`` has those that are."""
    (out / "labels").mkdir(parents=True, exist_ok=True)
    for case in cases:
        file = label_file(out, case)
        if not file.exists():
            write_row(file, make(case, out))
            sys.stderr.write(f"{case.name} drawn\n")
    rows = [json.loads(f.read_text("utf-8")) for f in sorted((out / "labels").glob("*.json"))]
    text = yaml.safe_dump({"cases": rows}, sort_keys=False)
    (out / "labels.yaml").write_text(text, encoding="utf-8")


def label_file(out: Path, case: Case) -> Path:
    """Return the file of a case's label."""
    return out / "labels" / f"{case.name}.json"


def line_of(label: Label, hidden: list[dict[str, Any]], row: dict[str, Any]) -> str:
    """Return what became of a case: verdict, floors, numbers hidden and found."""
    verdict = row["verdict"]
    floor = over_floor(verdict)
    said = [" or ".join(f"{e} at {p}" for e, p in sorted(s)) for s in named_sets(verdict)]
    said += [f"unknown {u['class']} {u['coordinate']}" for u in verdict.get("unknown", ())]
    parts = [
        f"{label.name} {label.kind}{'' if label.visible else ' (hardly visible)'}",
        f"hidden: {'; '.join(label.words) or label.kind}",
        f"said: {'; '.join(said) or row['error'] or 'nothing'}",
        f"came to: {outcome(label, verdict)}",
        "floor before, after: " + ("-" if floor is None else f"{floor[0]:.2f}, {floor[1]:.2f}"),
        f"{row['time_s']:.0f} s",
    ]
    for effect in hidden:
        parts.append(f"    hidden {effect['effect_class']} {effect['parameters']}")
    for effect in verdict.get("effects", ()):
        parts.append(f"    found {effect['effect']} {effect['parameters']}")
    return " | ".join(parts[:6]) + "".join(f"\n{part}" for part in parts[6:]) + "\n"


def main(arguments: Sequence[str] | None = None) -> int:
    """Draw, refine what has no row yet, print the table; return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.blind", description=__doc__)
    parser.add_argument("--cases", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--changed", action="store_true", help="a number that changes in each")
    parser.add_argument("--draw-only", action="store_true")
    parser.add_argument("--only", default="", help="names that contain this")
    given = parser.parse_args(arguments)
    out = given.out.absolute()
    deal = changed if given.changed else drawn
    cases = [c for c in deal(given.cases, given.seed) if given.only in c.name]
    entries = []
    for case in cases:
        draw([case], out)
        if given.draw_only:
            continue
        entry = json.loads(label_file(out, case).read_text("utf-8"))
        label = told(out, entry)
        pair = Pair(folder=out, name=case.name, part="blind", out=out / "work" / case.name)
        row = read_row(row_file(out, pair), KEYS)
        if row is None:
            row = refine(pair)
            write_row(row_file(out, pair), row)
            with (out / RESULTS).open("a", encoding="utf-8") as file:
                file.write(line_of(label, entry["effects"], row))
        entries.append(("blind", label, row))
    if entries:
        print(HEAD.format(cases=given.cases, seed=given.seed) + tables(entries))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
