"""The whole way: read, simulate, trace, judge, amend, report."""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.line.load import load_declaration
from sim_plant.refine.fit.objective import declared_objective
from sim_plant.refine.fit.start_angles import at_start_angles
from sim_plant.refine.judge.holdout import evaluate
from sim_plant.refine.model.hypotheses import library
from sim_plant.refine.model.nuisances import declared_nuisances
from sim_plant.refine.model.record_match import declaration_for, limits, twin_of
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.model.twin import Case, Twin
from sim_plant.refine.records.read import read_record
from sim_plant.refine.records.recording import Record
from sim_plant.refine.report.amend import plain, write_amended, write_block
from sim_plant.refine.report.folder import check_apart, check_folder, publish
from sim_plant.refine.report.outcome import Outcome, Plan
from sim_plant.refine.report.page import write_report
from sim_plant.refine.report.verdict import verdict
from sim_plant.refine.search.forward_selection import forward_selection
from sim_plant.refine.search.selection import Selection

Progress = Callable[[str], None]


def measured_of(twin: Twin, record: Record) -> Any:
    """Return the modelled channels of a record (channels, samples)."""
    return np.stack([record.columns[name] for name in twin.channels])


def find(
    twins: Sequence[Twin],
    records: Sequence[Record],
    without: Collection[str],
    workers: int,
    progress: Progress,
) -> Selection:
    """Return the trace of these records."""
    with SimulationPool(twins, workers) as pool:
        progress("simulating the declared line, its noise and its tolerances")
        measured = [measured_of(t, r) for t, r in zip(twins, records, strict=True)]
        check_runs(pool, records)
        objective = declared_objective(pool, measured)
        found = forward_selection(objective, library(twins[0].declaration, without), progress)
        progress(f"{pool.simulations} simulations")
    return found


def check_runs(pool: SimulationPool, records: Sequence[Record]) -> None:
    """Refuse a declared line that does not run under the references of its record.

    Raises
    ------
    PlantError
        When a simulation of it, at the quick or at the declared drive tick, comes to no end.
    """
    for runs in pool.run([Case(), Case(coarse=False)]):
        for record, run in zip(records, runs, strict=True):
            if not np.isfinite(run).all():
                raise PlantError(
                    f"{record.path}: the declared line does not run under this record's "
                    "references, its simulation diverges; look for a number of the line file "
                    "that is far off (inertia, EA_N, gains, corrections, effects)"
                )


def refine(plan: Plan, progress: Progress) -> Outcome:
    """Run everything and write the folder; nothing is written before all inputs are accepted.

    Raises
    ------
    PlantError
        On any input that cannot be judged.
    """
    check_folder(plan)
    line = load_declaration(plan.line)
    records = [read_record(p) for p in plan.records]
    twins = [twin_of(line, r) for r in records]
    held = [read_record(p) for p in plan.holdout]
    held_twins = [twin_of(line, r) for r in held]
    check_apart(records, held)
    twins, records = at_their_start_angles(twins, records)
    held_twins, held = at_their_start_angles(held_twins, held)
    if held:
        check_runs(SimulationPool(held_twins[:1], workers=1), held[:1])
    said = list(dict.fromkeys(text for t in twins for text in limits(t)))
    if not held:
        said.append("no held-out record: the error after is that of the record fitted")
    if len(held) > 1:
        said.append(f"more than one held-out record: the errors are those of {held[0].path.name}")
    for text in said:
        progress(f"cannot be claimed: {text}")
    for record in (*records, *held):
        for text in record.findings:
            progress(f"{record.path.name}: {text}")
    found = find(twins, records, plan.without, plan.workers, progress)
    if found.corrections:
        progress(f"{len(found.corrections)} declared numbers estimated anew with the effects")
    shown, twin = (held[0], held_twins[0]) if held else (records[0], twins[0])
    progress(f"judging on {shown.path.name}")
    with SimulationPool([twin], plan.workers) as pool:
        shifts = tuple(sorted(found.corrections.items()))
        judged = evaluate(
            pool, measured_of(twin, shown), found.fit.effects, shifts, find_angles=bool(held)
        )
    result = verdict(found, judged, str(shown.path))
    outcome = Outcome(
        plan=plan,
        records=(*records, *held),
        limits=tuple(said),
        selection=found,
        evaluation=judged,
        verdict=result,
        stated=twins[0].declaration.effects,
    )
    publish(plan, lambda into: write_all(replace(outcome, plan=into), plan.command))
    return outcome


def at_their_start_angles(
    twins: Sequence[Twin], records: Sequence[Record]
) -> tuple[list[Twin], list[Record]]:
    """Return twins whose declared effects begin where their record does, and records saying so."""
    found, told = [], []
    for twin, record in zip(twins, records, strict=True):
        turned, angles = at_start_angles(twin, measured_of(twin, record))
        text = tuple(
            f"what is declared at {place} begins {angle_rad:+.3g} rad further on than declared"
            for place, angle_rad in angles.items()
        )
        found.append(turned)
        told.append(replace(record, findings=(*record.findings, *text)))
    return found, told


def write_all(outcome: Outcome, command: str) -> None:
    """Write verdict, amended line, AFF block and report into the plan's folder."""
    plan, line = outcome.plan, load_declaration(outcome.plan.line)
    amended = None
    if outcome.selection.accepted:
        amended = write_amended(
            plan.line,
            plan.out,
            outcome.selection,
            outcome.records,
            command,
            outcome.verdict,
            outcome.stated,
        )
    block = write_block(plan.out, outcome.verdict["effects"], line, outcome.records[0])
    text = json.dumps(plain(outcome.verdict), indent=1) + "\n"
    (plan.out / "verdict.json").write_text(text, encoding="utf-8")
    own = declaration_for(line, outcome.records[0])
    tolerances = {n.name: n.tolerance for n in declared_nuisances(own)}
    write_report(outcome, command, amended, block, tolerances)
