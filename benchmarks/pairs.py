"""All pairs of data/lines, and each with its true effect taken out, as one table.

python -m benchmarks.pairs [--out DIR] [--only TEXT] [--swapped] [--docs]

``--swapped`` fits on record b and judges on a, with the whole library. ``--docs`` puts the table
between its marks in docs/results/refine-pairs.md.
Results are kept in DIR, one folder a run; a run that is there is not made again.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from aff_runtime.base.yaml_places import SafeLoader
from sim_plant.cli.main import main as sim_plant
from sim_plant.refine.report.verdict import UnknownFinding, Verdict

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / "data" / "lines"
PAGE = ROOT / "docs" / "results" / "refine-pairs.md"
BEGIN, END = "<!-- pairs: begin -->\n", "<!-- pairs: end -->\n"
TWINS = {"web_modulus at web": {"load_cell_calibration at all"}}
"""A common scale of all cells strains the web as a modulus does; transients alone tell them."""
NO_LINE = ("web_modulus", "load_cell_filter", "loop_delay")


@dataclass(frozen=True)
class Run:
    """One pair, with some effects taken out of the library; ``fit`` is the record fitted."""

    case: str
    without: tuple[str, ...] = ()
    fit: str = "a"

    @property
    def name(self) -> str:
        """Name of its folder."""
        first = self.case if self.fit == "a" else f"{self.case}_{self.fit}"
        return "-".join([first, *(f"without_{n}" for n in self.without)])

    @property
    def files(self) -> tuple[str, str, str]:
        """Line file, record to fit and record to judge on, as names."""
        held = "b" if self.fit == "a" else "a"
        return (
            f"{self.case}_{self.fit}.yaml",
            f"{self.case}_{self.fit}.csv.gz",
            f"{self.case}_{held}.csv.gz",
        )


def _yaml(name: str) -> Any:
    """Return the values of a file of data/lines, by libyaml where it is there."""
    text = (FOLDER / name).read_text(encoding="utf-8")
    return yaml.load(text, Loader=SafeLoader)


@cache
def labels() -> dict[str, list[tuple[str, str]]]:
    """Return the effects (name, location) of every pair."""
    cases = _yaml("labels.yaml")["cases"]
    return {c["case"]: [(e["effect_class"], e["location"]) for e in c["effects"]] for c in cases}


def plan(swapped: bool = False) -> list[Run]:
    """Return every pair as it is, without each of its effects, and without all of them."""
    if swapped:
        return [Run(case, fit="b") for case in labels()]
    runs = []
    for case, effects in labels().items():
        names = [name for name, _ in effects]
        runs.append(Run(case))
        runs += [Run(case, (name,)) for name in names]
        if len(names) > 1:
            runs.append(Run(case, tuple(sorted(names))))
    return runs


def verdict(run: Run, out: Path) -> Verdict:
    """Return the verdict of a run, made now if it is not in ``out``."""
    path = out / run.name / "verdict.json"
    if not path.exists():
        line, fit, held = (str(FOLDER / name) for name in run.files)
        taken = [part for name in run.without for part in ("--without", name)]
        done = sim_plant(
            ["refine", line, fit, "--holdout", held, "--out", str(path.parent), *taken]
        )
        assert done == 0
    return Verdict.from_json(path.read_text(encoding="utf-8"))


def faults(run: Run, result: Verdict) -> list[str]:
    """Return what is wrong with a verdict, as sentences; none when it is right."""
    label = labels()[run.case]
    left = {pair for pair in label if pair[0] not in run.without}
    found = {(e.place.effect, e.place.location) for e in result.effects}
    wrong = [f"{name} at {place} is not there" for name, place in sorted(found - left)]
    if not run.without:
        wrong += [f"{name} at {place} is missed" for name, place in sorted(left - found)]
        if result.answer != ("traced" if label else "nothing") and not told_as_twins(result):
            wrong.append(f"verdict is {result.answer}")
        return wrong
    if result.answer != "unknown":
        return [*wrong, f"verdict is {result.answer}"]
    for name, place in label:
        if name in run.without and not any(shows(run, name, place, u) for u in result.unknown):
            wrong.append(f"{name} at {place} is not among the unknown")
    return wrong


def told_as_twins(result: Verdict) -> bool:
    """Return whether every effect is told in a set with nothing but its twins."""
    return result.answer == "not_identifiable" and all(
        str(a.place) in TWINS and {str(p) for p in a.alternatives} <= TWINS[str(a.place)]
        for a in result.ambiguous
    )


def shows(run: Run, name: str, place: str, unknown: UnknownFinding) -> bool:
    """Return whether an unknown is what this effect would look like to who does not know it.

    On a roll or roller: its angle, or the web travel of its turn (or a harmonic). One that is no
    line: declared numbers beyond tolerance, or broadband; a delay in the loop of a roll that is
    not round shows at that roll's orders and nowhere else.
    """
    kind, where = unknown.unknown_class, unknown.coordinate
    locked_to = "unwind" if name == "loop_delay" else place
    if name in NO_LINE and kind in ("state", "broadband"):
        return True
    if name in NO_LINE and name != "loop_delay":
        return False
    if kind == "angle":
        return bool(where["roll"] == locked_to)
    if kind != "travel":
        return False
    line = _yaml(f"{run.case}_a.yaml")
    radius = next(r["radius_m"] for r in line["rollers"] if r["name"] == locked_to)
    order = radius / where["equivalent_radius_m"]
    return bool(round(order) >= 1 and abs(order / round(order) - 1.0) < 0.003)


def row(run: Run, result: Verdict) -> str:
    """Return one line of the table."""
    what = [str(e.place) for e in result.effects]
    what += [
        f"or {', '.join(map(str, a.alternatives))} in place of {a.place}" for a in result.ambiguous
    ]
    what += [f"unknown: {u.unknown_class}, {coordinate(u.coordinate)}" for u in result.unknown]
    judged = {n: e for n, e in result.residual_rms.items() if not n.endswith("_angle_rad")}
    before = [e.before / e.noise_floor for e in judged.values()]
    after = [e.after / e.noise_floor for e in judged.values()]
    tension = judged["unwind_tension_N"]
    cells = [
        run.case,
        "; ".join(f"{name} at {place}" for name, place in labels()[run.case]) or "healthy",
        ", ".join(run.without) or "-",
        "; ".join(what) or "nothing",
        "; ".join(faults(run, result)) or "yes",
        f"{tension.before:.3f} / {tension.after:.3f} / {tension.noise_floor:.3f}",
        *(f"{x:.2f}" for x in (np.median(before), np.median(after), max(after))),
    ]
    return f"| {' | '.join(cells)} |"


def coordinate(where: Mapping[str, object]) -> str:
    """Return a coordinate as words."""
    return ", ".join(
        f"{k} {v:.5g}" if isinstance(v, float) else f"{k} {v}" for k, v in where.items()
    )


HEAD = (
    "pair",
    "label",
    "taken out",
    "found",
    "right",
    "unwind tension held out, N: before / after / floor",
    "all held-out channels over floor, before: median",
    "after: median",
    "after: worst",
)


def table(out: Path, only: str = "", swapped: bool = False) -> tuple[str, int]:
    """Return the table and how many of its rows are wrong."""
    rows, wrong = [f"| {' | '.join(HEAD)} |", "|---" * len(HEAD) + "|"], 0
    for run in plan(swapped):
        if only in run.name:
            result = verdict(run, out)
            rows.append(row(run, result))
            wrong += bool(faults(run, result))
    return "\n".join(rows) + "\n", wrong


def written(page: str, found: str) -> str:
    """Return the page with the table between its marks."""
    before, _, rest = page.partition(BEGIN)
    return before + BEGIN + found + END + rest.partition(END)[2]


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("out/refine-pairs"))
    parser.add_argument("--only", default="")
    parser.add_argument("--swapped", action="store_true")
    parser.add_argument("--docs", action="store_true", help=f"write the table to {PAGE.name}")
    arguments = parser.parse_args()
    if arguments.docs and (arguments.only or arguments.swapped):
        parser.error("--docs writes the whole table: leave out --only and --swapped")
    found, misses = table(arguments.out, arguments.only, arguments.swapped)
    print(found, end="")
    if arguments.docs:
        PAGE.write_text(written(PAGE.read_text(encoding="utf-8"), found), encoding="utf-8")
    raise SystemExit(1 if misses else 0)
