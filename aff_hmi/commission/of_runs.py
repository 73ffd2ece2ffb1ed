"""Refining and maintenance in the reader's language.

What `verdict_sentences.py` does not know stays as it is in refine's own page, in English: the
names of numbers, experiments, an effect that is new.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from aff_hmi.commission.sentences import sentence, sentences
from aff_hmi.words import N_, Say
from aff_runtime.app.commission.views.of_refining import (
    LackingView,
    ProposalView,
    RefinedRow,
    RefinedView,
    RefiningView,
)
from aff_runtime.app.commission.views.of_weeks import (
    MaintenanceView,
    RankingRow,
    SupplierRankingRow,
    TrendRow,
)
from aff_runtime.base.refinement import EffectSaid, Summary

# what a verdict is: its mark, its word, and what it means
KINDS = {
    "nothing": ("✓", N_("nothing"), N_("the declared line explains the records to their noise")),
    "traced": ("●", N_("traced"), N_("what is left has a name, a place and a size")),
    "set": (
        "◐",
        N_("one of several"),
        N_("these records do not tell which: make the one that does"),
    ),
    "event": ("↯", N_("an event"), N_("something happened once: ask what was done then")),
    "unknown": (
        "?",
        N_("unknown"),
        N_("something is left that no effect of the library explains"),
    ),
    "": ("—", N_("no verdict"), N_("it runs, was stopped, or could not be done")),
}
QUANTITIES = {
    "shape": N_("shape"),
    "stroke": N_("stroke"),
    "ripple": N_("ripple"),
    "response ratio": N_("response ratio"),
    "friction": N_("friction"),
    "gain": N_("gain"),
    "phase": N_("phase"),
}
UNITS = {"um": "µm"}


@dataclass(frozen=True, slots=True, kw_only=True)
class ShownRow(RefinedRow):
    """A refinement in short, with the mark and the words of its verdict."""

    mark: str
    word: str
    means: str


def refining_in(view: RefiningView, say: Say) -> RefiningView:
    """Return what can be refined, and what was."""
    return replace(
        view,
        missing=tuple(sentence(text, say) for text in view.missing),
        lacking=_lacking(view.lacking, say) if view.lacking is not None else None,
        refined=tuple(_row(one, say) for one in view.refined),
    )


def refined_in(view: RefinedView, say: Say) -> RefinedView:
    """Return one refinement."""
    summary = view.summary
    if summary is not None:
        summary = _summary(summary, say)
    proposal = _proposal(view.proposal, say) if view.proposal is not None else None
    return replace(view, row=_row(view.row, say), summary=summary, proposal=proposal)


def _summary(said: Summary, say: Say) -> Summary:
    """Return a verdict."""
    return replace(
        said,
        headline=sentences(said.headline, say),
        sure=sentences(said.sure, say),
        gain=sentences(said.gain, say),
        next_step=sentences(said.next_step, say),
        unknown=tuple(sentence(one, say) for one in said.unknown),
        effects=tuple(_effect(one, say) for one in said.effects),
        limits=tuple(_of_record(one, say) for one in said.limits),
    )


def _effect(said: EffectSaid, say: Say) -> EffectSaid:
    return replace(
        said,
        place=sentence(said.place, say),
        text=sentence(said.text, say),
        to_do=sentence(said.to_do, say),
        others=tuple(sentence(one, say) for one in said.others),
    )


def maintenance_in(view: MaintenanceView, say: Say) -> MaintenanceView:
    """Return a line over weeks."""
    return replace(
        view,
        nothing=sentence(view.nothing, say),
        trends=tuple(_trend(one, say) for one in view.trends),
        without_a_line=tuple(sentence(text, say) for text in view.without_a_line),
        rankings=tuple(_ranking(one, say) for one in view.rankings),
        suppliers=tuple(_suppliers(one, say) for one in view.suppliers),
    )


def _lacking(view: LackingView, say: Say) -> LackingView:
    found = view.found
    records = tuple(
        replace(one, lacks=tuple(sentence(text, say) for text in one.lacks))
        for one in found.records
    )
    together = tuple(sentence(text, say) for text in found.together)
    return replace(view, found=replace(found, records=records, together=together))


def _of_record(text: str, say: Say) -> str:
    """Return a sentence that may begin with the name of its record."""
    said, (name, _, rest) = sentence(text, say), text.partition(": ")
    told = sentence(rest, say)
    return f"{name}: {told}" if said == text and told != rest else said


def _row(row: RefinedRow, say: Say) -> ShownRow:
    mark, word, means = KINDS.get(row.kind, KINDS["unknown"])
    return ShownRow(
        number=row.number,
        asked=row.asked,
        kind=row.kind,
        text=row.text,
        mark=mark,
        word=say(word),
        means=say(means),
    )


def _proposal(view: ProposalView, say: Say) -> ProposalView:
    return replace(view, against=sentence(view.against, say))


def _trend(row: TrendRow, say: Say) -> TrendRow:
    name, _, place = row.quantity.partition(" at ")  # of a response: at a frequency
    word = QUANTITIES.get(name)
    quantity = row.quantity
    if word is not None:
        quantity = ", ".join(filter(None, (say(word), place)))
    return replace(row, quantity=quantity, unit=UNITS.get(row.unit, row.unit))


def _ranking(row: RankingRow, say: Say) -> RankingRow:
    word = QUANTITIES.get(row.by)
    rolls = tuple(
        replace(
            one,
            **{
                name: replace(worst, unit=UNITS.get(worst.unit, worst.unit))
                for name in ("shape", "stroke", "ripple", "left")
                if (worst := getattr(one, name)) is not None
            },
        )
        for one in row.rolls
    )
    return replace(row, by=say(word) if word is not None else row.by, rolls=rolls)


def _suppliers(row: SupplierRankingRow, say: Say) -> SupplierRankingRow:
    word = QUANTITIES.get(row.by)
    rows = tuple(
        one
        if one.worst is None
        else replace(one, worst=replace(one.worst, unit=UNITS.get(one.worst.unit, one.worst.unit)))
        for one in row.suppliers
    )
    return replace(
        row,
        by=say(word) if word is not None else row.by,
        unit=UNITS.get(row.unit, row.unit),
        suppliers=rows,
    )
