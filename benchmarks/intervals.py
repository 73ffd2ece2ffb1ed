"""Do the intervals of refine hold what they say? Drawn effects, fitted where they are, no search.

python -m benchmarks.intervals [--rounds N] [--only TEXT] [--out DIR]

Records are the campaign's, sizes some times those it begins with. Seconds a draw; rows are kept, a
stopped run goes on.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.campaign.cases import Case, draw_fault
from benchmarks.campaign.effect_row import Form, Row, truth
from benchmarks.campaign.effect_table import BY_NAME, LIBRARY
from benchmarks.campaign.fault import Fault
from benchmarks.campaign.make import declared_for
from benchmarks.campaign.record import simulate, write_line, write_record
from benchmarks.campaign.score import wilson
from benchmarks.campaign.stage import stage
from benchmarks.campaign.work import web_at_moments
from benchmarks.rows import read_row, write_row
from sim_plant.line.load import load_line
from sim_plant.refine.fit.gauss_newton import Fit, nominal_fit
from sim_plant.refine.fit.objective import Objective, declared_objective
from sim_plant.refine.fit.roll_synchronisation import synchronised, synchronising_shifts
from sim_plant.refine.fit.spread import SPREAD
from sim_plant.refine.model.hypotheses import library, onset_library
from sim_plant.refine.model.record_match import twin_of
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.pipeline import Recorded
from sim_plant.refine.records.read import read_record
from sim_plant.refine.report.findings import effect_findings
from sim_plant.refine.search.added_effect import with_effect
from sim_plant.refine.search.effect_fit import fit_candidates
from sim_plant.refine.search.number_ranges import with_number_ranges
from sim_plant.refine.search.profile_detail import joint_refit
from sim_plant.refine.search.screening import screen
from sim_plant.refine.search.selection import AcceptedEffect, Selection

SIZES = (5.0, 1.5)
"""Times the size that the campaign begins with, round after round."""
LOOKS = 3
"""Starts that are fitted, best first look first."""
KEYS = ("name", "effect", "numbers", "excess")


def forms() -> list[tuple[Row, int, Form]]:
    """Return every form of every effect of the library of whose size something is told."""
    return [
        (row, turn, form)
        for row in LIBRARY
        for turn, form in enumerate(row.forms)
        if row.name != "out_of_round_roll"
    ]


def drawn(turn: int, at: int) -> Case:
    """Return draw ``at`` of a round, one effect of known numbers."""
    row, form_turn, form = forms()[at]
    rng = np.random.default_rng([turn, at])
    fault = draw_fault(rng, row.name, form_turn)
    wanted = abs(fault.size) * SIZES[turn % len(SIZES)]
    size = min(max(wanted, form.least), form.largest)
    if form.step:
        size = form.step * max(1, round(size / form.step))
    fault = replace(fault, size=math.copysign(size, fault.size))
    return Case(number=at, group="interval", seed=1000 * turn + at, faults=(fault,))


def written(case: Case, folder: Path) -> Path:
    """Write record ``a`` of a case and its line; return the record."""
    folder.mkdir(parents=True, exist_ok=True)
    at = stage(case, "a")
    guilty = at.guilty(case.faults)
    columns = simulate(guilty, at.told, at.angles, at.seed, colour=case.colour)
    write_record(columns, folder / "a.csv")
    write_line(declared_for(case, "a"), folder / "a.yaml")
    return folder / "a.csv"


def true_numbers(case: Case) -> dict[str, float]:
    """Return what is true of the effect's numbers, by their names in a verdict."""
    (fault,) = case.faults
    told = {name: float(value) for name, (value, _) in truth(BY_NAME[fault.effect], fault).items()}
    for name, value in fault.numbers:
        told.setdefault(name, value)
    if fault.from_s >= 0.0:
        told |= {"from_s": fault.from_s, "at_length_m": web_at_moments(case, case.faults)["0"][0]}
    return told


def starts(
    objective: Objective, nominal: Fit, fault: Fault, true: Mapping[str, float]
) -> list[Fit]:
    """Return fits of the drawn effect at its place: from its moment, or from first looks."""
    line = objective.pool.twins[0].declaration
    if fault.from_s < 0.0:
        here = [
            h
            for h in library(line)
            if h.effect.name == fault.effect and h.location == fault.location
        ]
        looks = screen(objective, nominal, here, _quiet)[:LOOKS]
        return [c.fit for c in fit_candidates(objective, nominal, looks, _quiet)]
    found = []
    for h in onset_library(line, 0):
        if h.effect.name == fault.effect and h.location == fault.location:
            start = [true.get(n, s) for n, s in zip(h.names, h.start, strict=True)]
            found.append(with_effect(objective, nominal, h, start, nominal.shifts))
    return [fit for fit in found if fit is not None]


def fitted(case: Case, folder: Path) -> tuple[Objective, Selection] | None:
    """Return the drawn effect as refine has it at the end of a search; None where none stands."""
    record = written(case, folder)
    line = load_line(folder / "a.yaml").declaration
    read = read_record(record)
    recorded = Recorded(record=read, twin=twin_of(line, read))
    objective = declared_objective(SimulationPool([recorded.twin], workers=1), [recorded.measured])
    start = nominal_fit(objective, synchronising_shifts(objective, {}))
    nominal = synchronised(objective, start)
    fits = starts(objective, nominal, case.faults[0], true_numbers(case))
    if not fits:
        return None
    best = min(fits, key=lambda fit: fit.cost)
    objective, fit = joint_refit(objective, best)
    accepted = AcceptedEffect(
        hypothesis=fit.hypotheses[-1],
        score=nominal.cost - best.cost,
        runner_up=None,
        margin=0.0,
        rejected=(),
    )
    return objective, Selection(
        nominal=nominal, fit=fit, travels=(), before=(), after=(), accepted=(accepted,)
    )


def row_of(name: str, case: Case, folder: Path) -> dict[str, Any]:
    """Return what the intervals of a draw say beside what is true, and what the fit leaves."""
    found, numbers, excess = fitted(case, folder), [], math.nan
    if found is not None:
        objective, selection = found
        selection = with_number_ranges(objective, selection)
        excess = objective.excess(selection.fit.cost, selection.fit.residual)
        excess /= objective.cost_standard_deviation
        (said,) = effect_findings(selection)
        for number, true in true_numbers(case).items():
            if number in said.interval95:
                low, high = said.interval95[number]
                value = float(said.parameters[number])
                numbers.append(
                    {"name": number, "value": value, "true": true, "low": low, "high": high}
                )
    return {"name": name, "effect": case.faults[0].effect, "numbers": numbers, "excess": excess}


def error_ratio(number: Mapping[str, float]) -> float:
    """Return the error over the standard deviation that the interval stands for on its side."""
    value, true = number["value"], number["true"]
    side = number["high"] - value if true > value else value - number["low"]
    return (value - true) / max(side / SPREAD, 1e-300)


def page(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return the table: a line per effect and number, then all together."""
    groups: dict[tuple[str, str], list[Mapping[str, float]]] = defaultdict(list)
    for row in rows:
        for number in row["numbers"]:
            groups[row["effect"], number["name"]].append(number)
    lines = [
        "| effect | number | held | error over sd, rms | half width, % |",
        "|---|---|---|---|---|",
    ]
    lines += [_line(*key, numbers) for key, numbers in groups.items()]
    every = [number for numbers in groups.values() for number in numbers]
    if every:
        lines.append(_line("all", "", every))
        held = sum(_holds(number) for number in every)
        low, high = wilson(held, len(every))
        lines += ["", f"{held} of {len(every)} held ({100 * low:.0f} to {100 * high:.0f} %)"]
    gone = [row["name"] for row in rows if not row["numbers"]]
    return "\n".join([*lines, f"no fit stands: {', '.join(gone) or 'none'}"]) + "\n"


def _holds(number: Mapping[str, float]) -> bool:
    return number["low"] <= number["true"] <= number["high"]


def _line(effect: str, name: str, numbers: Sequence[Mapping[str, float]]) -> str:
    held = sum(_holds(number) for number in numbers)
    ratio = math.sqrt(float(np.mean([error_ratio(number) ** 2 for number in numbers])))
    widths = [0.5 * (n["high"] - n["low"]) / max(abs(n["true"]), 1e-300) for n in numbers]
    width = f"{100 * float(np.median(widths)):.2f}"
    return f"| {effect} | {name} | {held} of {len(numbers)} | {ratio:.2f} | {width} |"


def _quiet(_: str) -> None:
    """Say nothing."""


def draws(rounds: int, only: str) -> Iterator[tuple[str, Case]]:
    """Yield the draws asked for by name."""
    for turn in range(rounds):
        for at, (row, form_turn, _) in enumerate(forms()):
            name = f"{turn}-{at:02d}-{row.name}-{form_turn}"
            if only in name:
                yield name, drawn(turn, at)


def main(arguments: Sequence[str] | None = None) -> int:
    """Draw, fit, print the table; return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.intervals", description=__doc__)
    parser.add_argument("--rounds", type=int, default=len(SIZES))
    parser.add_argument("--only", default="", help="names that contain this")
    parser.add_argument("--out", type=Path, default=Path("out/intervals"))
    given = parser.parse_args(arguments)
    rows = []
    for name, case in draws(given.rounds, given.only):
        kept = given.out / "rows" / f"{name}.json"
        row = read_row(kept, KEYS)
        if row is None:
            row = row_of(name, case, given.out / "work" / name)
            write_row(kept, row)
            sys.stderr.write(f"{name}: {len(row['numbers'])} numbers\n")
        rows.append(row)
    print(page(rows))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
