"""One self-contained HTML page for a process engineer who has to decide."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from jinja2 import Environment, PackageLoader

from aff_runtime.base.channel_units import unit_of_name
from aff_runtime.base.clock import wall_time_iso
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.nuisances import declared_nuisances
from sim_plant.refine.report.aff_block import AffBlock, actuators_for, aff_blocks
from sim_plant.refine.report.beside_rival import beside_rival
from sim_plant.refine.report.facts import NOTHING_KNOWN, RefineFacts
from sim_plant.refine.report.near_steps import near_steps
from sim_plant.refine.report.next_step import PERIODIC, next_step
from sim_plant.refine.report.partly import partly
from sim_plant.refine.report.parts_shown import loudest, overlays
from sim_plant.refine.report.plots import channels_by_error, spectrum, wavenumber_map
from sim_plant.refine.report.sketch import sketch
from sim_plant.refine.report.tables import ShiftRow, above_noise, best_each, error_rows, shift_rows
from sim_plant.refine.report.verdict import effects_word
from sim_plant.refine.report.wording import (
    claim_words,
    coordinate_text,
    location_words,
    number_rows,
    place_words,
    size_of,
)
from sim_plant.refine.search.selection import alike_margin

if TYPE_CHECKING:
    from sim_plant.refine.judge.holdout import Evaluation
    from sim_plant.refine.report.outcome import Outcome
    from sim_plant.refine.report.verdict import UnknownFinding, Verdict


SHOWN_SHIFTS = 5
"""Declared numbers estimated anew that the page shows; it folds the others away."""


def headline(verdict: Verdict, facts: RefineFacts = NOTHING_KNOWN) -> str:
    """Return the verdict in a few sentences: what, where, how large, and whether that is all."""
    if verdict.answer == "nothing":
        return "Nothing found: the declared line explains the record fitted to its noise."
    rivals = {a.place: a.alternatives for a in verdict.ambiguous}
    names = [
        ", ".join(filter(None, (claim_words(e.place, also, facts.along), size_of(e))))
        for e in verdict.effects
        for also in (rivals.get(e.place, ()),)
    ]
    text = f"{effects_word(verdict.answer)}: {'; '.join(names)}." if names else ""
    left_out = " and ".join(name.replace("_", " ") for name in facts.without)
    library = f"library without {left_out} (left out on request)" if left_out else "library"
    for item in verdict.unknown:
        said = coordinate_text(
            item.unknown_class, item.coordinate, item.begins, item.also, facts.tolerances
        )
        text += f" Unknown: {said}; no effect of the {library} explains it."
    return f"{text} {partly(verdict, facts)}".strip()


def confidence(verdict: Verdict, facts: RefineFacts = NOTHING_KNOWN) -> str:
    """Return how far each effect is ahead of what else might explain the record."""
    said, unsure = [], {a.place: a.alternatives for a in verdict.ambiguous}
    for e in verdict.effects:
        text = f"{place_words(e.place)} scores {e.score:.0f}, "
        if e.runner_up and e.runner_up in unsure.get(e.place, ()):
            text += f"its rival ({place_words(e.runner_up)}) {e.score - e.margin:.0f}: "
            text += "not told apart, for errors of the model may make that difference"
        elif e.runner_up:
            text += f"the next best explanation ({place_words(e.runner_up)}) "
            text += f"{e.score - e.margin:.0f}"
            least = alike_margin(e.score)
            if e.margin >= least:
                text += f": told apart, for errors of the model make up to {least:.0f}"
        else:
            text += "no other explains the record as well"
        said.append(text)
    sure = ["; ".join(said) + "."] if said else []
    sure += [beside_rival(e, verdict.residual_rms) for e in verdict.effects]
    less = partly(verdict, facts)
    less = less and f"A score says which explanation is best, not that it is enough. {less}"
    return " ".join(
        filter(
            None,
            [
                *sure,
                *_seen(verdict, facts),
                *facts.near_steps,
                less,
                *_sure_of_unknown(verdict.unknown),
            ],
        )
    )


def _seen(verdict: Verdict, facts: RefineFacts) -> list[str]:
    """Return what the readings themselves showed of an effect, where that is something else."""
    if not facts.sample_time_s:
        return []
    rows = [(e, BY_NAME[e.place.effect].seen) for e in verdict.effects]
    texts = [(e, seen(e.parameters, facts.sample_time_s)) for e, seen in rows if seen is not None]
    return [f"{place_words(e.place)}: {text}." for e, text in texts if text]


def _sure_of_unknown(unknown: Sequence[UnknownFinding]) -> list[str]:
    """Return how much more than noise the unknown is, as sentences."""
    lines = [f"{item.chi2_reduction:.0f}" for item in unknown if item.unknown_class in PERIODIC]
    least = CRITERIA.search.unexplained.periodic
    said = [
        f"What repeats there takes {', '.join(lines)} of the weighted squared error, by noise "
        f"alone it would be less than {least:.0f}."
    ]
    left = {
        "event": (
            "From that moment on the weighted squared error is {:.0f} more than noise makes it."
        ),
        "gap": "A gap takes {:.0f} of the squared difference of reading and speeds, in noise.",
        "state": (
            "The shifts of all declared numbers, squared in standard deviations, add up to {:.0f}."
        ),
    }
    rest = "The weighted squared error that is left is {:.0f} more than noise makes it."
    others = [
        left.get("gap" if "gap_N" in item.coordinate else item.unknown_class, rest).format(
            item.chi2_reduction
        )
        for item in unknown
        if item.unknown_class not in PERIODIC
    ]
    return [*(said if lines else []), *others]


def gain(judged: Evaluation, held: bool, *, is_amended: bool = True) -> str:
    """Return what the amended line explains: on the tension and the channel that gained most.

    Parameters
    ----------
    is_amended : the amended line is another one than the declared.
    """
    ranked = channels_by_error(judged)
    tensions = [k for k in ranked if judged.channels[k].endswith("_N")]
    where = "On the held-out record" if held else "On the record fitted (no proof)"
    said = []
    before = judged.rms_declared if is_amended else judged.rms_amended
    for at in dict.fromkeys([*tensions[:1], ranked[0]]):
        unit = unit_of_name(judged.channels[at])
        said.append(
            f"the error in {judged.channels[at]} is "
            f"{before[at]:.3g} {unit} rms as declared"
            + (f", {judged.rms_amended[at]:.3g} {unit} as amended" if is_amended else "")
            + f"; noise alone leaves {judged.floor[at]:.3g} {unit}"
        )
    return f"{where} {'. There '.join(said)}. {_left(judged, ranked, is_amended=is_amended)}"


def _left(judged: Evaluation, ranked: Sequence[int], *, is_amended: bool) -> str:
    """Return which tensions and speeds hold more than noise as amended."""
    line = "amended" if is_amended else "declared"
    above = above_noise(judged, ranked)
    if not above:
        return f"As {line}, all tensions and speeds are within 10 % of noise."
    named = ", ".join(f"{name} (x {ratio:.2f})" for name, ratio in above.items())
    return f"As {line}, more than 10 % above noise: {named}."


def next_of(outcome: Outcome, facts: RefineFacts) -> str:
    """Return what the reader may do now; ``facts``: see ``facts_of``."""
    judged, verdict = outcome.evaluation, outcome.verdict
    return next_step(
        verdict,
        {b.roll: actuators_for(b.roll, outcome.line.declaration) for b in blocks_of(outcome)},
        above_noise(judged, channels_by_error(judged)),
        facts,
        outcome.caveats,
    )


def facts_of(outcome: Outcome) -> RefineFacts:
    """Return what the words of the verdict need of line and records."""
    return RefineFacts(
        along=tuple(roller.name for roller in outcome.declared.rollers),
        without=outcome.plan.without,
        sample_time_s=outcome.selection.record_axes[0].sample_time_s,
        shifts=tuple(shifts_of(outcome)),
        tolerances={n.name: n.tolerance for n in declared_nuisances(outcome.declared)},
        is_proposed=outcome.proposal is not None and bool(outcome.proposal.adds),
        near_steps=near_steps(outcome.verdict, outcome.records[: len(outcome.plan.records)]),
        loudest=loudest(outcome),
    )


def blocks_of(outcome: Outcome) -> list[AffBlock]:
    """Return the AFF blocks to paste."""
    return aff_blocks(outcome.verdict.effects)


def shifts_of(outcome: Outcome) -> list[ShiftRow]:
    """Return the declared numbers as estimated anew with the effects."""
    tolerances = {n.name: n.tolerance for n in declared_nuisances(outcome.declared)}
    return shift_rows(outcome.selection.adjustments, tolerances)


def write_report(outcome: Outcome, command: str, amended: Path | None, block: Path | None) -> Path:
    """Write ``report.html``; return its path."""
    judged, selection = outcome.evaluation, outcome.selection
    verdict, step_s = outcome.verdict, selection.record_axes[0].sample_time_s
    is_amended, shifts, facts = outcome.is_amended, shifts_of(outcome), facts_of(outcome)
    template = Environment(
        loader=PackageLoader("sim_plant.refine.report", "."), autoescape=True
    ).get_template("page.html.j2")
    page = template.render(
        headline=headline(verdict, facts),
        line_name=outcome.plan.line.stem,
        made=wall_time_iso()[:10],
        record_names=", ".join(r.path.name for r in outcome.records),
        records_said=outcome.records_said(),
        sure=confidence(verdict, facts),
        gain=gain(judged, bool(outcome.plan.holdout), is_amended=is_amended),
        next_step=next_of(outcome, facts),
        verdict=verdict,
        rows=error_rows(judged),
        command=command,
        caveats=outcome.caveats,
        records=outcome.records,
        held=outcome.plan.holdout,
        judged=outcome.judged.path.name,
        fitted=outcome.records[0].path.name,
        judged_s=judged.measured.shape[1] * step_s,
        is_amended=is_amended,
        accepted=selection.accepted,
        angles=judged.angles_rad,
        unwound=judged.unwound_m,
        mains=judged.frequencies_Hz,
        shifts=shifts,
        shown_shifts=max(SHOWN_SHIFTS, sum(row.is_far for row in shifts)),
        keys={key for e in verdict.effects for key in e.parameters},
        unknown_words=lambda u: coordinate_text(
            u.unknown_class, u.coordinate, u.begins, u.also, facts.tolerances
        ),
        proposed=facts.is_proposed,
        best_each=best_each,
        numbers=number_rows,
        place_words=place_words,
        location_words=location_words,
        above=CRITERIA.report.above_noise,
        far=CRITERIA.report.outside_tolerance,
        block=block.read_text(encoding="utf-8") if block else "",
        unsure=open_blocks(outcome),
        amended=amended.name if amended else "",
        sketch=sketch(outcome.declared, verdict),
        overlays=overlays(outcome),
        order_map=wavenumber_map(judged, step_s, draw_amended=is_amended),
        spectra=spectrum(
            selection.spectra_declared[0],
            selection.spectra_left[0],
            CRITERIA.search.unexplained.periodic,
            draw_amended=is_amended,
        ),
    )
    path = outcome.plan.out / "report.html"
    path.write_text(page, encoding="utf-8")
    return path


def open_blocks(outcome: Outcome) -> list[str]:
    """Return what has to be confirmed before its block may be used: it is told from no other."""
    rolls = {block.roll for block in blocks_of(outcome)}
    return [place_words(a.place) for a in outcome.verdict.ambiguous if a.place.location in rolls]
