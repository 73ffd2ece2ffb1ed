"""Refine the measured records without a line and write the table.

python -m benchmarks.records [--out DIR] [--docs DIR]
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from aff_runtime.base.python_child import module_command

ROOT = Path(__file__).resolve().parents[2]
PLACES = tuple(base / "shared" / "data" for base in (ROOT, ROOT.parent))
BELT = ROOT / "config/records/treadmill_belt.yaml"
WINDING = ROOT / "config/records/winding.yaml"
SLOW_1, SLOW_2, FAST = (
    f"treadmill_belt/Random{name}.txt.gz" for name in ("SlowSpeed1", "SlowSpeed2", "FastSpeed1")
)
BEGIN, END = "<!-- records: begin -->", "<!-- records: end -->"
HEADS = (
    "fitted",
    "held out",
    "output",
    "declared filter",
    "41 taps",
    "with effects",
    "with lines",
    "on the readings as they came: declared / 41 taps / with effects",
    "general effects",
    "lines",
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One run: declaration, records to fit, record to judge on (none for the winding record)."""

    declaration: Path
    fitted: tuple[str, ...]
    held: str = ""


CASES = (
    Case(declaration=BELT, fitted=(SLOW_1, FAST), held=SLOW_2),
    Case(declaration=BELT, fitted=(SLOW_1,), held=SLOW_2),
    Case(declaration=BELT, fitted=(FAST,), held=SLOW_1),
    Case(declaration=BELT, fitted=(FAST,), held=SLOW_2),
    Case(declaration=BELT, fitted=(SLOW_1,), held=FAST),
    Case(declaration=BELT, fitted=(SLOW_1, SLOW_2), held=FAST),
    Case(declaration=WINDING, fitted=("winding/winding.dat.gz",)),
)


def refine(case: Case, data: Path, out: Path) -> dict[str, Any]:
    """Run the product's command line on one case and return its verdict."""
    held = ("--holdout", str(data / case.held)) if case.held else ()
    command = [
        *(*module_command("sim_plant.cli.main"), "refine", str(case.declaration)),
        *(str(data / name) for name in case.fitted),
        *(*held, "--out", str(out)),
    ]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    found: dict[str, Any] = json.loads((out / "verdict.json").read_text(encoding="utf-8"))
    return found


def short(name: str) -> str:
    """Return a record's name without folder, ending and what all have in common."""
    return Path(name).name.split(".")[0].removeprefix("Random")


def rows_of(case: Case, verdict: dict[str, Any]) -> list[str]:
    """Return the table rows of one case, one for every output."""
    rows = []
    for output, error in verdict["residual_rms"].items():
        model = verdict["models"][output]
        stamps = model["rms_at_stamps"]
        effects = [
            f"{e['effect']}: " + ", ".join(_number(n, v, e["interval95"][n]) for n, v in mine)
            for e in verdict["general_effects"]
            if e["output"] == output
            for mine in [e["numbers"].items()]
        ]
        cells = (
            ", ".join(map(short, case.fitted)),
            short(case.held) or "(none)",
            output,
            f"{error['before']:.3f}",
            f"{model['plain_least_squares_rms']:.3f}",
            f"{model['chosen_rms']:.3f}" + (" (not used)" if model["fell_back"] else ""),
            f"{error['after']:.3f}",
            " / ".join(f"{stamps[k]:.2f}" for k in ("declared", "plain", "chosen"))
            if stamps
            else "",
            "; ".join(effects) or "none",
            str(len(verdict["unknown"])),
        )
        rows.append(f"| {' | '.join(cells)} |")
    return rows


def _number(name: str, value: float, interval: Sequence[float]) -> str:
    """Return a number with its interval; times in ms."""
    what, _, record = name.partition(" of ")
    scale, unit = (1e3, " ms") if what.endswith("_s") and "per" not in what else (1.0, "")
    low, high = (f"{scale * x:.3g}" for x in interval)
    said = what.removesuffix("_s") if unit else what
    return f"{said} of {short(record)} {scale * value:.3g}{unit} ({low} to {high})"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run all cases; 2 where the records are not here."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("out/refine-records"))
    parser.add_argument("--docs", type=Path, default=None, help="write the table there")
    given = parser.parse_args(arguments)
    data = next((p for p in PLACES if (p / "treadmill_belt").is_dir()), None)
    if data is None:
        sys.stderr.write(f"measured records are not here; looked in {[*map(str, PLACES)]}\n")
        return 2
    rows = []
    for k, case in enumerate(CASES):
        rows += rows_of(case, refine(case, data, given.out / f"case{k + 1}"))
        print(rows[-1], flush=True)
    head = f"| {' | '.join(HEADS)} |\n|{'---|' * len(HEADS)}"
    table = "\n".join([head, *rows])
    if given.docs:
        page = given.docs / "refine-records.md"
        text = page.read_text(encoding="utf-8")
        before, after = text.split(BEGIN)[0], text.split(END)[1]
        page.write_text(f"{before}{BEGIN}\n{table}\n{END}{after}", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
