"""Records without a line declaration: filter, general effects and spectral lines, judged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from jinja2 import Environment, PackageLoader
from scipy.interpolate import make_interp_spline

from sim_plant.base.arrays import Array
from sim_plant.refine.report.announce import announce, holdout_caveats
from sim_plant.refine.report.folder import check_apart, check_folder, publish
from sim_plant.refine.search.candidate import Progress
from sim_plant.refine.without_line.free_spectral_lines import (
    SpectralLine,
    clocks,
    find_spectral_lines,
)
from sim_plant.refine.without_line.general.effect import OutputRecord
from sim_plant.refine.without_line.general.findings import (
    Delay,
    Finding,
    delays_of,
    findings,
    pruned,
)
from sim_plant.refine.without_line.general.judging import Judged, explained_by, judge, rms
from sim_plant.refine.without_line.general.least_squares import parts_of
from sim_plant.refine.without_line.general.search import CONSTANT, GAIN_ALONE, Search, search
from sim_plant.refine.without_line.judged_spectral_lines import without_spectral_lines
from sim_plant.refine.without_line.record_filter import (
    RecordDeclaration,
    left_of,
    output_record,
    read_stamped,
)
from sim_plant.refine.without_line.stamps import Stamped
from sim_plant.refine.without_line.verdict import (
    OutputModel,
    OutputRms,
    RecordVerdict,
    headline,
    next_step,
)
from sim_plant.refine.without_line.wording import effect_text, spectral_line_text

if TYPE_CHECKING:
    from sim_plant.refine.report.outcome import RefineRequest

NO_TRAVEL = (
    "no column is an absolute speed or angle: a frequency cannot be tied to a roller, no roller "
    "is claimed"
)
NO_INPUTS = "no inputs are declared: nothing is explained but zero, drift and spectral lines"


def caveats_of(declaration: RecordDeclaration) -> list[str]:
    """Return what cannot be claimed without a line, as sentences."""
    sentences = [
        "no line declaration: no place can be named, a spectral line is named by its coordinate"
    ]
    if declaration.travel_speed is None:
        sentences.append(NO_TRAVEL)
    if not declaration.inputs:
        sentences.append(NO_INPUTS)
    return sentences


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Output:
    """One output explained: search, what it gives on the record judged, what is claimed.

    Attributes
    ----------
    explained : of every record fitted (judged,).
    claimed : the effects that are claimed.
    refused : what is not claimed, as sentences.
    delays : by input: how far the output is behind it by a gain alone.
    """

    name: str
    search: Search
    judged: Judged
    explained: tuple[Array, ...]
    claimed: tuple[Finding, ...]
    refused: tuple[str, ...]
    delays: dict[str, Delay]


def refine_records(
    plan: RefineRequest, declaration: RecordDeclaration, progress: Progress
) -> RecordVerdict:
    """Run filter, general effects and spectral lines; write verdict and report, return it.

    ``declaration`` is in the file that the plan names as its line.

    Raises
    ------
    PlantError
        On any input that cannot be judged; nothing is written then.
    """
    check_folder(plan)
    stamped = [read_stamped(declaration, p) for p in (*plan.records, *plan.holdout)]
    everything = [s.record for s in stamped]
    records, held = everything[: len(plan.records)], everything[len(plan.records) :]
    check_apart(records, held)
    caveats = [*caveats_of(declaration), *holdout_caveats(held)]
    announce(caveats, everything, progress)
    at = len(records) if held else 0  # of the record judged on: the first held out, or fitted
    outputs = [
        _output(declaration, name, stamped[: len(records)], stamped[at], progress)
        for name in declaration.outputs
    ]
    items = [
        left_of(declaration, r, np.stack([o.explained[k] for o in outputs]))
        for k, r in enumerate(records)
    ]
    left_judged = left_of(
        declaration, stamped[at].record, np.stack([o.judged.explained for o in outputs])
    )
    progress("searching spectral lines in time and travel")
    lines = find_spectral_lines(items)
    machine = [x for x in lines if not x.clock]
    for x in lines:
        progress(f"  {spectral_line_text(x)}{': ' + x.clock if x.clock else ''}")
    left_over = without_spectral_lines(items, machine, left_judged, own=not held)
    verdict = RecordVerdict(
        unknown=tuple(machine),
        clocks=(*(x for x in lines if x.clock), *clocks(items)),
        not_claimed=(*caveats, *(text for o in outputs for text in o.refused)),
        holdout=str((plan.holdout or plan.records)[0]),
        general_effects=tuple(x for o in outputs for x in o.claimed),
        residual_rms={o.name: _error(o, left) for o, left in zip(outputs, left_over, strict=True)},
        models={
            o.name: _model(o, declaration, stamped[at], left, machine)
            for o, left in zip(outputs, left_over, strict=True)
        },
    )
    hashes = [(r.path.name, r.sha256) for r in everything]
    publish(plan, lambda into: _write(into, declaration, verdict, hashes, plan.command))
    return verdict


def _output(
    declaration: RecordDeclaration,
    name: str,
    fitted: Sequence[Stamped],
    judged_on: Stamped,
    progress: Progress,
) -> _Output:
    """Return one output with its filter and general effects."""
    records = [output_record(declaration, s.record, name) for s in fitted]
    record = output_record(declaration, judged_on.record, name)
    progress(f"{name}: trying filters and general effects")
    chosen = search(records, progress)
    refused: list[str] = []
    if judged_on not in fitted:
        chosen, refused = pruned(chosen, records, record)
    judged = judge(chosen, record)
    if judged.fell_back:
        refused.append(
            f"{name}: what was chosen leaves {judged.chosen_rms:.5g} on the record held out, more "
            f"than plain least squares; that is used, and no general effect is claimed"
        )
    if record.standardised:
        refused.append(
            f"{name}: the inputs have mean 0 and variance 1, no zero and no unit of them is left: "
            "no sign, band, limit or curve is looked for"
        )
    names = (name, [s.record.path.name for s in fitted], judged_on.record.path.name)
    claimed = findings(chosen, judged, records, record, names)
    for x in claimed:
        progress(f"  {effect_text(x)}")
    parts = parts_of(judged.used.model, records)
    alone = chosen.gain_alone
    return _Output(
        name=name,
        search=chosen,
        judged=judged,
        explained=tuple(a @ judged.used.weights for a in parts),
        claimed=tuple(claimed),
        refused=tuple(refused),
        delays=delays_of(alone, records) if alone is not None else {},
    )


def _error(o: _Output, left: Array) -> OutputRms:
    """Return the error of an output; spectral lines count only where they make it smaller."""
    return OutputRms(before=o.judged.declared_rms, after=min(rms(left), _least_rms(o.judged)))


def _least_rms(judged: Judged) -> float:
    """Return the smallest error of the three filters, without spectral lines."""
    return min(judged.chosen_rms, judged.plain_rms, judged.declared_rms)


def _model(
    o: _Output,
    declaration: RecordDeclaration,
    judged_on: Stamped,
    left: Array,
    machine: Sequence[SpectralLine],
) -> OutputModel:
    model = o.judged.used.model
    taps = model.ahead + model.back + 1
    text = f"{taps} taps, {model.ahead} ahead and {model.back} back"
    if model.delays:
        text = GAIN_ALONE
    if model.back < 0:
        text = CONSTANT
    return OutputModel(
        filter=text,
        fell_back=o.judged.fell_back,
        plain_rms=o.judged.plain_rms,
        chosen_rms=o.judged.chosen_rms,
        with_spectral_lines=bool(machine) and rms(left) <= _least_rms(o.judged),
        tried=o.judged.rows,
        delays=o.delays,
        at_stamps=_at_stamps(o, output_record(declaration, judged_on.record, o.name), judged_on),
    )


def _at_stamps(o: _Output, record: OutputRecord, judged_on: Stamped) -> dict[str, float]:
    """Return the error on the readings as they came, none of them put on a grid."""
    if judged_on.time_s is None:
        return {}
    stamps_s = judged_on.time_s
    first = record.end_samples * record.step_s
    grid = first + record.step_s * np.arange(record.judged.size)
    use = (stamps_s >= grid[0]) & (stamps_s <= grid[-1])
    readings = judged_on.readings[o.name][use]

    def error(explained: Array) -> float:
        smooth = make_interp_spline(grid, explained, k=3)
        return rms(readings - smooth(stamps_s[use]))

    return {
        "declared": error(explained_by(o.search.declared, record, shift=False, own=False)),
        "plain": error(explained_by(o.search.plain, record, shift=False, own=False)),
        "chosen": error(o.judged.explained),
    }


def _write(
    plan: RefineRequest,
    declaration: RecordDeclaration,
    verdict: RecordVerdict,
    records: Sequence[tuple[str, str]],
    command: str,
) -> None:
    (plan.out / "verdict.json").write_text(verdict.to_json(), encoding="utf-8")
    template = Environment(
        loader=PackageLoader("sim_plant.refine.without_line", "."), autoescape=True
    ).get_template("page.html.j2")
    page = template.render(
        note=declaration.note,
        verdict=verdict,
        records=records,
        command=command,
        headline=headline(verdict),
        held=bool(plan.holdout),
        next_step=next_step(verdict, has_travel=declaration.travel_speed is not None),
    )
    (plan.out / "report.html").write_text(page, encoding="utf-8")
