"""The whole way: read, simulate, trace, judge, amend, report."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array
from sim_plant.line.declaration import Declaration
from sim_plant.line.load import LineFile
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.objective import declared_objective
from sim_plant.refine.fit.start_angles import at_start_angles
from sim_plant.refine.judge.holdout import Evaluation, evaluate
from sim_plant.refine.judge.refutation import (
    as_declared,
    leaves_much,
    made_worse,
    refuted,
    shows_something_else,
    takes_less_than_left,
    takes_little,
)
from sim_plant.refine.judge.rest_shown import rest_in_floors, rest_shown
from sim_plant.refine.lacking import caveats_of
from sim_plant.refine.model.demand import demand_of
from sim_plant.refine.model.hypotheses import library
from sim_plant.refine.model.record_match import twin_of
from sim_plant.refine.model.run_caveats import lines_of, shared
from sim_plant.refine.model.run_match import run_on_line
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.model.twin import Case, Twin
from sim_plant.refine.records.read import read_record
from sim_plant.refine.records.recording import Recording
from sim_plant.refine.report.aff_block import started_blocks, write_block
from sim_plant.refine.report.amend import write_amended
from sim_plant.refine.report.announce import announce, holdout_caveats, shared_angle
from sim_plant.refine.report.findings import verdict_of
from sim_plant.refine.report.folder import check_apart, check_folder, publish
from sim_plant.refine.report.outcome import Outcome, Plan, RecordOfOnset
from sim_plant.refine.report.page import write_report
from sim_plant.refine.report.site_edit import FILE as SITE
from sim_plant.refine.report.site_edit import Proposal, SiteFile, proposed
from sim_plant.refine.report.summary import write_summary
from sim_plant.refine.report.verdict import Verdict
from sim_plant.refine.search.candidate import Progress
from sim_plant.refine.search.forward_selection import forward_selection
from sim_plant.refine.search.selection import Selection, withdrawn, without_accepted
from sim_plant.refine.search.set_apart import has_large_wander
from sim_plant.refine.search.unexplained import Unknown, line_or_broadband, rings, strongest_peak
from sim_plant.refine.search.unknown_event import event_in

LINE_CYCLES = CRITERIA.search.unexplained.spectral_line_cycles


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RecordWithTwin:
    """A record and the twin of the line that it was made on."""

    record: Recording
    twin: Twin

    @property
    def measured(self) -> Array:
        """The modelled channels of the record (channels, samples)."""
        return np.stack([self.record.columns[name] for name in self.twin.channels])


def refine(plan: Plan, line: LineFile, progress: Progress) -> Outcome:
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
    selection = find(fitted, plan.without, plan.workers, progress)
    if selection.corrections:
        progress(f"{len(selection.corrections)} declared numbers estimated anew with the effects")
    judged = held[0] if held else fitted[0]
    progress(f"judging on {judged.record.path.name}")
    evaluation = judge(judged, selection, plan.workers, progress, held_out=bool(held))
    if held:
        claimed = confirmed(judged, selection, evaluation, plan.workers, progress)
        selection, evaluation = claimed.selection, claimed.evaluation
        caveats += claimed.said
    verdict = verdict_of(
        selection,
        evaluation,
        str(judged.record.path),
        [(f.record.path.name, f.twin) for f in fitted],
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
    ]


def proposal_of(outcome: Outcome, site: SiteFile, progress: Progress) -> Proposal | None:
    """Return the site file with the AFF blocks, and remarks on it; None without a block."""
    line, first = outcome.line.declaration, outcome.records[0]
    blocks = started_blocks(outcome.verdict.effects, line, first)
    if not blocks:
        return None
    proposal = proposed(site, blocks, line, outcome.selection.corrections)
    for text in proposal.said:
        progress(f"{site.path.name}: {text}")
    return proposal


def read_all(plan: Plan, line: Declaration) -> tuple[list[RecordWithTwin], list[RecordWithTwin]]:
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
    twin, angles = at_start_angles(recorded.twin, recorded.measured)
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
        tried = library(twins[0].declaration, without, demand_of(twins))
        selection = forward_selection(objective, tried, progress, without)
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


def judge(
    judged: RecordWithTwin,
    selection: Selection,
    workers: int,
    progress: Progress,
    *,
    held_out: bool,
) -> Evaluation:
    """Return the error of one record as declared and as amended."""
    shifts = tuple(sorted(selection.corrections.items()))
    with SimulationPool([judged.twin], workers, progress) as pool:
        return evaluate(pool, judged.measured, selection.fit.effects, shifts, find_angles=held_out)


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
    number = moments[0].number
    there = [replace(e, record=None) for e in selection.fit.effects if e.record in (None, number)]
    shown, shifts = fitted[number], tuple(sorted(selection.corrections.items()))
    with SimulationPool([shown.twin], workers, progress) as pool:
        found = evaluate(pool, shown.measured, there, shifts, find_angles=False)
    return RecordOfOnset(moment=moments[0], evaluation=found)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Claimed:
    """What is claimed once effects were left out that the record held out does not confirm.

    Attributes
    ----------
    said : a sentence on each of those: which, and why it is not claimed.
    """

    selection: Selection
    evaluation: Evaluation
    said: tuple[str, ...] = ()


def confirmed(
    judged: RecordWithTwin,
    selection: Selection,
    evaluation: Evaluation,
    workers: int,
    progress: Progress,
) -> Claimed:
    """Return what the record held out confirms: all is withdrawn that it refutes or imitates."""
    said: tuple[str, ...] = ()
    against = refutation(selection, evaluation)
    if against:
        said = (not_confirmed(selection, judged.record, against),)
        progress(said[0])
        selection, evaluation = withdrawn(selection), as_declared(evaluation)
    claimed = without_imitations(judged, selection, evaluation, workers, progress)
    return replace(claimed, said=(*said, *claimed.said))


def without_imitations(
    judged: RecordWithTwin,
    selection: Selection,
    evaluation: Evaluation,
    workers: int,
    progress: Progress,
) -> Claimed:
    """Return what is claimed without effects that can be imitations, one after the other.

    What an imitation explained has a cause that is not named. Where the record held out shows
    surely more than noise without it, that is unknown, and the verdict says so. So does it where
    the weakest stays for its response is shown, or where most of what that record shows is
    something else than the effects, which are there.
    """
    said: list[str] = []
    while (weak := without_weakest_imitation(judged, selection, evaluation, workers, progress)) and (
        not weak.shown
    ):
        said.append(weak.said)
        progress(weak.said)
        selection, evaluation = weak.selection, weak.evaluation
    found = bool(selection.accepted) and not selection.unknown
    beside = weak is not None or (found and shows_something_else(evaluation))
    if leaves_much(evaluation) and (said or beside):
        stays = stays_unknown(judged, selection, evaluation)
        said.append(f"unknown: what is left on {judged.record.path.name}: {stays.text}")
        progress(said[-1])
        selection = replace(selection, unknown=(stays,))
    return Claimed(selection=selection, evaluation=evaluation, said=tuple(said))


def stays_unknown(judged: RecordWithTwin, selection: Selection, evaluation: Evaluation) -> Unknown:
    """Return what is left on the record held out: what begins there, a spectral line, or neither.

    Beside an effect that is never quite constant neither is named: its changes have moments and
    slow lines of their own. Nor is a line of fewer cycles than ``spectral_line_cycles``: a drift
    of the record has such lines at any coordinate.
    """
    after, chi2_reduction = rest_shown(judged.twin, evaluation)
    irregular = Unknown(unknown_class="broadband", chi2_reduction=chi2_reduction, coordinate={})
    if any(has_large_wander(accepted) for accepted in selection.accepted):
        return irregular
    names, rest = rest_in_floors(evaluation)
    event = event_in(judged.twin.declaration, names, rest**2, evaluation.first)
    if event is None or rings([after], event[1]):
        spectrum, at, _ = strongest_peak([after])
        sure = at * spectrum.extent >= LINE_CYCLES
        return line_or_broadband([after], chi2_reduction, chi2_reduction) if sure else irregular
    where = event[0] | {"held_out": judged.record.path.name}
    return Unknown(unknown_class="event", chi2_reduction=event[1], coordinate=where)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class WithoutImitation:
    """What is claimed without an effect that can be an imitation.

    Attributes
    ----------
    said : the sentence that names the effect and why it is not claimed.
    shown : the record shows its response, so it stays all the same.
    """

    selection: Selection
    evaluation: Evaluation
    said: str
    shown: bool


def without_weakest_imitation(
    judged: RecordWithTwin,
    selection: Selection,
    evaluation: Evaluation,
    workers: int,
    progress: Progress,
) -> WithoutImitation | None:
    """Return what is claimed without the weakest effect, where it can be an imitation, or None.

    It can be one where it takes less away on the record held out than all effects leave there,
    and that is surely more than noise. A lone effect, or one beside something unknown, is not
    looked at; nor is an event that the record held out does not have: of that it says nothing.
    """
    if selection.unknown or len(selection.accepted) < 2 or not leaves_much(evaluation):
        return None
    shown = [
        k
        for k, accepted in enumerate(selection.accepted)
        if not accepted.hypothesis.moment or str(accepted.hypothesis.key) in evaluation.moments
    ]
    if not shown:
        return None
    at = min(shown, key=lambda k: selection.accepted[k].score)
    fewer = without_accepted(selection, at)
    without = judge(judged, fewer, workers, progress, held_out=True)
    if not takes_less_than_left(evaluation, without):
        return None
    key = selection.accepted[at].hypothesis.key
    said = f"not claimed: {key}: takes less away on {judged.record.path.name} than is left there"
    stays = not takes_little(evaluation, without)
    return WithoutImitation(selection=fewer, evaluation=without, said=said, shown=stays)


def refutation(selection: Selection, evaluation: Evaluation) -> str:
    """Return why the record held out refutes the effects found, as part of a sentence, or ""."""
    if not selection.accepted:
        return ""
    if not selection.unknown:
        return "explains what was fitted, and not" if refuted(evaluation) else ""
    worse = made_worse(evaluation)
    return f"beside what is unknown, and {', '.join(worse)} worse with it in" if worse else ""


def not_confirmed(selection: Selection, record: Recording, against: str) -> str:
    """Return the sentence on effects that the record held out refutes."""
    effects = " and ".join(str(accepted.hypothesis.key) for accepted in selection.accepted)
    return f"not claimed: {effects}: {against} {record.path.name}"


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
