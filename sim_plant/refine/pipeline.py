"""The whole way: read, simulate, trace, judge, amend, report."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.line.declared.declaration import Declaration
from sim_plant.line.reading.load import LineFile
from sim_plant.refine.confirm import RecordWithTwin, confirmed, judge
from sim_plant.refine.fit.objective import declared_objective
from sim_plant.refine.fit.start_angles import with_effects_as_the_record_begins
from sim_plant.refine.judge.holdout import evaluate
from sim_plant.refine.lacking import caveats_of
from sim_plant.refine.model.demand import demand_of
from sim_plant.refine.model.hypotheses import all_hypotheses
from sim_plant.refine.model.record_match import twin_of
from sim_plant.refine.model.run_caveats import lines_of, rolls_of, shared, site_of_other_line
from sim_plant.refine.model.run_match import run_on_line
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.model.twin import Case
from sim_plant.refine.records.read import read_record
from sim_plant.refine.records.recording import Recording
from sim_plant.refine.report.aff_block import started_blocks, write_block
from sim_plant.refine.report.amend import write_amended
from sim_plant.refine.report.announce import (
    announce,
    holdout_caveats,
    radii_of_profiles,
    shared_angle,
)
from sim_plant.refine.report.findings import verdict_of
from sim_plant.refine.report.folder import check_apart, check_folder, publish
from sim_plant.refine.report.outcome import Outcome, RecordOfOnset, RefineRequest
from sim_plant.refine.report.page import write_report
from sim_plant.refine.report.site_edit import FILE as SITE
from sim_plant.refine.report.site_edit import Proposal, SiteFile, proposed
from sim_plant.refine.report.summary import write_summary
from sim_plant.refine.report.verdict import Verdict
from sim_plant.refine.rivals import left_by_rivals, with_rivals_refitted
from sim_plant.refine.search.candidate import Progress
from sim_plant.refine.search.forward_selection import forward_selection
from sim_plant.refine.search.selection import Selection


def refine(plan: RefineRequest, line: LineFile, progress: Progress) -> Outcome:
    """Run refine and write the plan's folder; nothing is written before all inputs are accepted.

    ``line`` is the file that the plan names.

    Raises
    ------
    PlantError
        On any input that cannot be judged.
    """
    check_folder(plan)
    site = SiteFile.read(plan.site) if plan.site is not None else None
    fitted, held = read_all(plan, line.declaration)
    records = tuple(one.record for one in (*fitted, *held))
    caveats = caveats_of_all(fitted, held)
    announce(caveats, records, progress)
    if site is not None:
        for text in site_of_other_line(site.names.name, records):
            progress(f"--site {site.path.name}: {text}")
    selection = find(fitted, plan.without, plan.workers, progress)
    if selection.adjustments:
        progress(f"{len(selection.adjustments)} declared numbers estimated anew with the effects")
    judged = held[0] if held else fitted[0]
    progress(f"judging on {judged.record.path.name}")
    evaluation = judge(judged, selection, plan.workers, progress, held_out=bool(held))
    if held:
        claimed = confirmed(judged, selection, evaluation, plan.workers, progress)
        selection, evaluation = claimed.selection, claimed.evaluation
        caveats += claimed.said
    caveats += radii_of_profiles(selection, fitted[0].twin.declaration)
    verdict = verdict_of(
        selection,
        evaluation,
        str(judged.record.path),
        [(f.record.path.name, f.twin) for f in fitted],
        left_by_rivals(judged, selection, plan.workers, progress, held_out=bool(held)),
    )
    outcome = Outcome(
        plan=plan,
        line=line,
        declared=fitted[0].twin.declaration,
        records=records,
        caveats=tuple(caveats),
        selection=selection,
        evaluation=evaluation,
        verdict=verdict,
        record_of_onset=record_of_onset(fitted, selection, verdict, plan.workers, progress),
    )
    if site is not None:
        outcome = replace(outcome, proposal=proposal_of(outcome, site, progress))
    publish(plan, lambda into: write_all(replace(outcome, plan=into), plan.command))
    return outcome


def caveats_of_all(fitted: Sequence[RecordWithTwin], held: Sequence[RecordWithTwin]) -> list[str]:
    """Return what cannot be claimed from the records, one by one and together, as sentences."""
    of_fitted, of_held = [f.record for f in fitted], [h.record for h in held]
    return [
        *caveats_of([(f.record, f.twin) for f in fitted]),
        *shared_angle(of_fitted),
        *holdout_caveats(of_held),
        *shared(of_fitted, of_held),
        *lines_of((*of_fitted, *of_held)),
        *rolls_of(of_fitted),
    ]


def proposal_of(outcome: Outcome, site: SiteFile, progress: Progress) -> Proposal | None:
    """Return the site file with the AFF blocks, and remarks on it; None without a block."""
    line, first = outcome.line.declaration, outcome.records[0]
    blocks = started_blocks(outcome.verdict.effects, line, first)
    if not blocks:
        return None
    proposal = proposed(site, blocks, line, outcome.selection.adjustments)
    odd = site_of_other_line(site.names.name, outcome.records)
    proposal = replace(proposal, said=(*odd, *proposal.said))
    for text in proposal.said:
        progress(f"{site.path.name}: {text}")
    return proposal


def read_all(
    plan: RefineRequest, line: Declaration
) -> tuple[list[RecordWithTwin], list[RecordWithTwin]]:
    """Return the records to fit and those held out, each with its twin.

    Raises
    ------
    PlantError
        When one cannot be read, is no record of this line, is given twice, or its line does not
        run.
    """
    records = [run_on_line(line, read_record(path)) for path in plan.records]
    fitted = [RecordWithTwin(record=r, twin=twin_of(line, r)) for r in records]
    records_held = [run_on_line(line, read_record(path)) for path in plan.holdout]
    held = [RecordWithTwin(record=r, twin=twin_of(line, r)) for r in records_held]
    check_apart(records, records_held)
    fitted, held = ([at_its_start_angles(r) for r in part] for part in (fitted, held))
    if held:
        first = held[0]
        check_runs(SimulationPool([first.twin], workers=1), [first.record])
    return fitted, held


def at_its_start_angles(recorded: RecordWithTwin) -> RecordWithTwin:
    """Return the record with declared effects at its own start angles, which its findings name."""
    twin, angles = with_effects_as_the_record_begins(recorded.twin, recorded.measured)
    text = tuple(
        f"{what if ' at ' in what else f'what is declared at {what}'} begins {angle_rad:+.3g} rad "
        "further on than declared"
        for what, angle_rad in angles.items()
    )
    record = replace(recorded.record, findings=(*recorded.record.findings, *text))
    return RecordWithTwin(record=record, twin=twin)


def find(
    fitted: Sequence[RecordWithTwin], without: Collection[str], workers: int, progress: Progress
) -> Selection:
    """Return the effects that explain the records; those in ``without`` are not tried."""
    twins = [f.twin for f in fitted]
    with SimulationPool(twins, workers, progress) as pool:
        progress("simulating the declared line, its noise and its tolerances")
        check_runs(pool, [f.record for f in fitted])
        objective = declared_objective(pool, [f.measured for f in fitted])
        tried = all_hypotheses(twins[0].declaration, without, demand_of(twins))
        selection = forward_selection(objective, tried, progress, without)
        selection = with_rivals_refitted(objective, selection, progress)
        progress(f"{pool.simulations} simulations")
    return selection


def check_runs(pool: SimulationPool, records: Sequence[Recording]) -> None:
    """Refuse a declared line that does not run under the references of its record.

    Raises
    ------
    PlantError
        When a simulation of it, at the quick or at the declared drive tick, comes to no end.
    """
    for runs in pool.run([Case(), Case(quick=False)]):
        for record, run in zip(records, runs, strict=True):
            if not np.isfinite(run).all():
                raise PlantError(
                    f"{record.path}: the declared line does not run under this record's "
                    "references, its simulation diverges; look for a number of the line file "
                    "that is far off (inertia, EA_N, gains, corrections, effects)"
                )


def record_of_onset(
    fitted: Sequence[RecordWithTwin],
    selection: Selection,
    verdict: Verdict,
    workers: int,
    progress: Progress,
) -> RecordOfOnset | None:
    """Return the fitted record in which the first of what was found begins, to be shown there."""
    known = [e.begins for e in verdict.effects]
    unknown = [u.begins for u in verdict.unknown]
    moments = [moment for moment in (*known, *unknown) if moment is not None]
    if not moments:
        return None
    index = moments[0].record_index
    own = [e for e in selection.fit.effects if e.record_index in (None, index)]
    there = [replace(e, record_index=None) for e in own]
    shown, shifts = fitted[index], tuple(sorted(selection.adjustments.items()))
    with SimulationPool([shown.twin], workers, progress) as pool:
        found = evaluate(pool, shown.measured, there, shifts, find_angles=False)
    return RecordOfOnset(moment=moments[0], evaluation=found)


def write_all(outcome: Outcome, command: str) -> None:
    """Write verdict, amended line, AFF block and report into the plan's folder."""
    out, first = outcome.plan.out, outcome.records[0]
    amended = None
    if outcome.selection.accepted:
        amended = write_amended(
            outcome.line,
            out,
            outcome.selection,
            outcome.records,
            command,
            outcome.verdict,
            outcome.declared.effects,
        )
    block = write_block(out, outcome.verdict.effects, outcome.line.declaration, first)
    if outcome.proposal is not None and outcome.proposal.adds:
        (out / SITE).write_text(outcome.proposal.text, encoding="utf-8")
    (out / "verdict.json").write_text(outcome.verdict.to_json(), encoding="utf-8")
    write_summary(outcome)
    write_report(outcome, command, amended, block)
