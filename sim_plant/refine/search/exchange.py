"""After the search: every effect is tried elsewhere beside all others, and taken out once.

What was chosen while others were still missing may sit a roller off, or be no longer needed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from sim_plant.base.effects import Effect
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.line.arrays.locations import bridles, candidate_locations
from sim_plant.line.declared.declaration import Declaration
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit, gauss_newton_fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.model.hypotheses import Hypothesis, hypothesis
from sim_plant.refine.search.candidate import Progress, bic_penalty, sure_fall
from sim_plant.refine.search.completeness import left_at_own_line, sure_excess
from sim_plant.refine.search.degenerate_pair import of_other_kind
from sim_plant.refine.search.outside_prior import joint_conflict
from sim_plant.refine.search.selection import ACCEPTANCE, AcceptedEffect, Selection, alike_margin
from sim_plant.refine.spectra.coordinates import RecordAxes

EXCHANGE = CRITERIA.search.exchange


def exchanged(objective: Objective, selection: Selection, progress: Progress) -> Selection:
    """Return the selection with every effect at the place where it explains most beside the rest.

    Places that explain as much are named with it; so is the place it is moved from, while the fit
    leaves more than noise or has gained no more than the margin. What the best place leaves at its
    own spectral line is an error of the record or of the model: one of that size may as well be
    at a rival, so one that leaves no more than twice as much there is named too. Of an effect that
    the records do not tell from what stood in for it (``shared``) all is named that ends the
    conflict of declared numbers as well.
    """
    fit, accepted = selection.fit, list(selection.accepted)
    for k in range(len(accepted)):
        was = fit
        margin = alike_margin(selection.nominal.cost - fit.cost)
        places = _elsewhere(objective, selection.record_axes, fit.hypotheses[k], accepted[k])
        tried = [(there.key, _moved(objective, fit, k, there)) for there in places]
        tried = [(place, other) for place, other in tried if np.isfinite(other.cost)]
        here = fit.hypotheses[k].key
        for place, other in tried:
            if other.cost < fit.cost - margin:
                progress(f"{here} is better told as {place} beside the others")
                fit = other
        there = fit.hypotheses[k].key
        known_to = max(
            margin, left_at_own_line(objective, fit, selection.record_axes, fit.hypotheses[k])
        )
        alike = [
            place
            for place, other in tried
            if other.cost < fit.cost + known_to
            or (accepted[k].shared and joint_conflict(objective, other) is None)
        ]
        # missing effects had favoured the first place; those still missing may favour the other
        undecided = selection.fit.cost < fit.cost + margin or leaves_more(objective, fit)
        undecided = undecided or accepted[k].shared
        if there != here and here not in alike and undecided:
            alike.append(here)
        judged = {place for place, _ in tried}
        others = [p for p in accepted[k].ambiguous if p.effect != there.effect and p not in judged]
        chosen = replace(
            accepted[k],
            hypothesis=fit.hypotheses[k],
            ambiguous=tuple(p for p in dict.fromkeys([*others, *alike]) if p != there),
        )
        gains = {place: was.cost - other.cost for place, other in tried}
        told = scored_at(chosen, gains | {here: 0.0}) if there != here or alike else chosen
        rival = next((other for place, other in tried if place == told.runner_up), told.rival)
        accepted[k] = replace(told, rival=rival)
    return replace(selection, fit=fit, accepted=tuple(accepted))


def with_rivals_at_own_line(objective: Objective, selection: Selection) -> Selection:
    """Return the selection of a lone effect with the places named that its own line does not tell.

    As in ``exchanged``, by the scores of the search: those behind by no more than what the
    effect leaves at its own spectral line.
    """
    (found,) = selection.accepted
    h = found.hypothesis
    known_to = left_at_own_line(objective, selection.fit, selection.record_axes, h)
    behind = [
        place
        for place, score in found.rejected
        if place.effect == h.effect.name and found.score - score < known_to
    ]
    alike = tuple(dict.fromkeys([*found.ambiguous, *behind]))
    return replace(selection, accepted=(replace(found, ambiguous=alike),))


def scored_at(chosen: AcceptedEffect, gains: Mapping[EffectAt, float]) -> AcceptedEffect:
    """Return an effect with score, rival and rejected list as of the place it was moved to.

    A place that cannot be told from it goes before the others, as its next best explanation.

    Parameters
    ----------
    chosen : the effect at its new place, with the scores of the old one.
    gains : chi-square that each place explains more than the old one, all else fitted again; the
        price of the numbers is the same everywhere.
    """
    here = chosen.hypothesis.key
    told = {place: chosen.score + gain for place, gain in gains.items()}
    rows = dict(chosen.rejected) | told
    del rows[here]
    rejected = sorted(rows.items(), key=lambda row: (row[0] not in chosen.ambiguous, -row[1]))
    runner_up, second = rejected[0] if rejected else (None, 0.0)
    return replace(
        chosen,
        score=told[here],
        runner_up=runner_up,
        margin=told[here] - max(second, 0.0),
        rejected=tuple(rejected[: ACCEPTANCE.reported_rejected]),
    )


def leaves_more(objective: Objective, fit: Fit) -> bool:
    """Return whether a fit leaves more than noise, the steps of coarse words counted as well.

    Those steps show nothing of what is missing, but they may favour one of two places.
    """
    return fit.cost - objective.expected_cost > sure_excess(objective)


def joined(objective: Objective, selection: Selection, progress: Progress) -> Selection:
    """Return the selection with one effect on an S-wrap where each of its rollers had the same.

    The same web passes them under the same conditions: one cause with one set of numbers is
    likelier than several, unless it leaves a good part of what they explain.
    """
    line = objective.pool.twins[0].declaration
    for bridle, bodies in bridles(line).items():
        rollers = [line.rollers[k].name for k in bodies]
        for name in dict.fromkeys(h.effect.name for h in selection.fit.hypotheses):
            selection = _on_bridle(objective, selection, name, bridle, rollers, progress)
    return selection


def _on_bridle(
    objective: Objective,
    selection: Selection,
    name: str,
    bridle: str,
    rollers: Sequence[str],
    progress: Progress,
) -> Selection:
    """Return the selection with effect ``name`` on one S-wrap, see ``joined``."""
    fit = selection.fit
    rows = [(k, h) for k, h in enumerate(fit.hypotheses) if h.effect.name == name]
    at = [k for k, h in rows if h.location in rollers]
    if {fit.hypotheses[k].location for k in at} != set(rollers) or len(at) != len(rollers):
        return selection
    first, *others = at
    h = fit.hypotheses[first]
    if any(fit.hypotheses[k].names != h.names for k in others):
        return selection
    line = objective.pool.twins[0].declaration
    if bridle not in candidate_locations(line, h.effect):
        return selection
    there = replace(
        hypothesis(h.effect, bridle, h.fixed, h.names, line), record_index=h.record_index
    )
    mean = [float(np.mean(column)) for column in zip(*(fit.values[k] for k in at), strict=True)]
    one = fit.with_effect_at(first, there, mean)
    other = _without(objective, one, *others)
    most = EXCHANGE.bridle_share * (selection.nominal.cost - fit.cost)
    if other.cost > fit.cost + most:
        return selection
    progress(f"{name} at {' and '.join(rollers)} is told as {there.key}")
    accepted = list(selection.accepted)
    accepted[first] = replace(accepted[first], hypothesis=there)
    kept = tuple(a for k, a in enumerate(accepted) if k not in others)
    return replace(selection, fit=other, accepted=kept)


def pruned(objective: Objective, selection: Selection, progress: Progress) -> Selection:
    """Return the selection without effects that are not missed when all else is fitted again."""
    while len(selection.accepted) > 1:
        fit = selection.fit
        losses = []
        for k, h in enumerate(fit.hypotheses):
            without = _without(objective, fit, k)
            loss = sure_fall(objective, without, fit)
            losses.append(loss - bic_penalty(objective, len(h.names)))
        k = int(np.argmin(losses))
        if losses[k] > EXCHANGE.missed:
            return selection
        progress(f"{fit.hypotheses[k].key} is not missed beside the others")
        selection = replace(
            selection,
            fit=_without(objective, fit, k),
            accepted=(*selection.accepted[:k], *selection.accepted[k + 1 :]),
        )
    return selection


def _elsewhere(
    objective: Objective, axes: Sequence[RecordAxes], h: Hypothesis, accepted: AcceptedEffect
) -> list[Hypothesis]:
    """Return what is worth a try in place of an effect: near by, close, or named with it.

    The same effect at other places. And what else rolls at its wavenumber: that line is told by
    the radius of a roller, not by what is wrong with it.
    """
    line = objective.pool.twins[0].declaration
    near = _near(line, h.effect, h.location)
    close = [p for p, _ in accepted.rejected if p.effect == h.effect.name][: EXCHANGE.close]
    alike = [p for p in accepted.ambiguous if p.effect == h.effect.name]
    places = [p for p in dict.fromkeys([*close, *alike, *near]) if p != h.key]
    there = [
        replace(
            hypothesis(h.effect, p.location, h.fixed, h.names, line), record_index=h.record_index
        )
        for p in places
    ]
    if accepted.shared:
        return [*there, *_stood_in(line, h, accepted)]
    if not axes:
        return there
    other = [p for p, _ in accepted.rejected if p.effect != h.effect.name]
    named = [p for p in accepted.ambiguous if p.effect != h.effect.name]
    others = of_other_kind(axes[0], h, dict.fromkeys([*named, *other]))
    return [*there, *others[: EXCHANGE.close]]


def _near(line: Declaration, effect: Effect, location: str) -> list[EffectAt]:
    """Return an effect at the bodies of one kind near by; of a profile none."""
    names = [roller.name for roller in line.rollers]
    if location not in names or effect.place != "body" or effect.profiles is not None:
        return []
    at = names.index(location)
    first, end = _within_reach(line, at, whole_zone=bool(effect.declared_as))
    kinds = ("idler",) if line.rollers[at].kind == "idler" else ("driven",)
    return [EffectAt(effect.name, r.name) for r in line.rollers[first:end] if r.kind in kinds]


def _stood_in(line: Declaration, h: Hypothesis, accepted: AcceptedEffect) -> list[Hypothesis]:
    """Return declared numbers of another kind named with a shared one, at every place near by."""
    others = [p for p in accepted.ambiguous if p.effect != h.effect.name]
    named = [p for p in others if BY_NAME[p.effect].declared_as]
    near = [other for p in named for other in _near(line, BY_NAME[p.effect], p.location)]
    return [
        hypothesis(BY_NAME[p.effect], p.location, line=line)
        for p in dict.fromkeys([*named, *near])
    ]


def _within_reach(line: Declaration, at: int, *, whole_zone: bool) -> tuple[int, int]:
    """Return first and end of the rollers that are near body ``at``.

    With ``whole_zone`` all idlers of its zone: there an effect that changes a declared number is
    constant, and looks the same at any idler unless a reading lies between.
    """
    first, end = max(0, at - EXCHANGE.reach), at + EXCHANGE.reach + 1
    if not whole_zone or line.rollers[at].kind != "idler":
        return first, end
    others = [k for k, r in enumerate(line.rollers) if r.kind != "idler"]
    before = max((k for k in others if k < at), default=-1)
    behind = min((k for k in others if k > at), default=len(line.rollers))
    return min(first, before + 1), max(end, behind)


def _moved(objective: Objective, fit: Fit, k: int, there: Hypothesis) -> Fit:
    """Return the fit with ``there`` in place of effect ``k``.

    Of infinite cost where the same effect has other numbers there. Another effect begins absent:
    what rolls at one wavenumber is linear in its two numbers.
    """
    h = fit.hypotheses[k]
    values = dict(zip(h.names, fit.values[k], strict=True))
    if there.effect is not h.effect:
        values = dict(zip(there.names, there.absent, strict=True))
    elif set(there.names) != set(h.names):
        return replace(fit, cost=float("inf"))
    moved = fit.with_effect_at(k, there, [values[name] for name in there.names])
    return gauss_newton_fit(
        objective, moved.hypotheses, moved.values, fit.shifts, rounds=EXCHANGE.rounds
    )


def _without(objective: Objective, fit: Fit, *out: int) -> Fit:
    """Return the fit without the effects ``out``, all others fitted again."""
    keep = [k for k in range(len(fit.hypotheses)) if k not in out]
    return gauss_newton_fit(
        objective,
        [fit.hypotheses[k] for k in keep],
        [fit.values[k] for k in keep],
        fit.shifts,
        rounds=EXCHANGE.rounds,
    )
