"""The verdict in the words of the page, as JSON for a screen."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict

from aff_runtime.base.channel_units import unit_of_name
from aff_runtime.base.refinement import SUMMARY, EffectSaid, ErrorSaid, NumberSaid, Summary
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.report.outcome import Outcome
from sim_plant.refine.report.page import confidence, facts_of, gain, headline, next_of
from sim_plant.refine.report.tables import error_rows
from sim_plant.refine.report.verdict import Ambiguity, EffectFinding, Verdict
from sim_plant.refine.report.wording import coordinate_text, number_rows, place_words, remedy


def write_summary(outcome: Outcome) -> None:
    """Write ``summary.json`` into the plan's folder."""
    said = json.dumps(asdict(summary(outcome)), indent=1)
    (outcome.plan.out / SUMMARY).write_text(f"{said}\n", encoding="utf-8")


def summary(outcome: Outcome) -> Summary:
    """Return the verdict in words."""
    verdict, judged, held = outcome.verdict, outcome.evaluation, outcome.plan.holdout
    facts = facts_of(outcome)
    rivals = {a.place: a for a in verdict.ambiguous}
    return Summary(
        kind=kind_of(verdict),
        headline=headline(verdict, facts),
        sure=confidence(verdict, facts),
        gain=gain(judged, bool(held), is_amended=outcome.is_amended),
        next_step=next_of(outcome, facts),
        effects=tuple(_effect(e, rivals) for e in verdict.effects),
        unknown=tuple(
            coordinate_text(u.unknown_class, u.coordinate, u.begins, u.also, facts.tolerances)
            for u in verdict.unknown
        ),
        errors=tuple(
            ErrorSaid(
                channel=row.name,
                unit=unit_of_name(row.name),
                before=row.before,
                after=row.after,
                floor=row.floor,
            )
            for row in error_rows(judged)
        ),
        limits=outcome.caveats,
        judged_on=outcome.judged.path.name,
        held_out=bool(held),
        site_said=outcome.proposal.said if outcome.proposal is not None else (),
    )


def kind_of(verdict: Verdict) -> str:
    """Return a verdict's answer, but ``event`` if every unknown is one, ``set`` if ambiguous."""
    if verdict.answer == "unknown":
        is_event = all(one.unknown_class == "event" for one in verdict.unknown)
        return "event" if is_event else "unknown"
    return "set" if verdict.answer == "not_identifiable" else verdict.answer


def _effect(e: EffectFinding, rivals: Mapping[EffectAt, Ambiguity]) -> EffectSaid:
    rival = rivals.get(e.place)
    return EffectSaid(
        place=place_words(e.place),
        text=e.text,
        numbers=tuple(
            NumberSaid(name=n.name, value=n.value, unit=n.unit, low=n.low, high=n.high)
            for n in number_rows(e)
        ),
        can_cancel=e.cancel,
        to_do=remedy(e),
        others=tuple(map(place_words, rival.alternatives)) if rival is not None else (),
        experiments=rival.experiments if rival is not None else (),
    )
