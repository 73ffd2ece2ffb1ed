"""Trace a residual to effects, one after another, against generic terms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.fit.gauss_newton import Fit, gauss_newton_fit, nominal_fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.fit.roll_synchronisation import synchronised, synchronised_shifts
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.search.completeness import (
    cost_standard_deviation,
    explains_own_lines,
    remaining_spectra,
)
from sim_plant.refine.search.effect_fit import profile_reinitialised, with_effect
from sim_plant.refine.search.free_terms import LINE_KINDS, explained_by_free_term, free_term_basis
from sim_plant.refine.search.outside_prior import starts_outside_prior, total_shifts
from sim_plant.refine.search.profile_detail import joint_refit
from sim_plant.refine.search.screening import (
    bic_penalty,
    every_third_idler,
    neighbours,
    screen,
    with_line_support,
)
from sim_plant.refine.search.selection import (
    DISCREPANCY,
    AcceptedEffect,
    FittedCandidate,
    Progress,
    Selection,
    claim,
    is_line,
)
from sim_plant.refine.search.unexplained import Unknown, unexplained_parts
from sim_plant.refine.spectra.coordinates import travel_of

MOST_EFFECTS = 4
MOST_BOXES = 2


def forward_selection(
    objective: Objective, library: Sequence[Hypothesis], progress: Progress
) -> Selection:
    """Return effects that explain the records, and what remains unexplained.

    Where a line remains that no effect explains, it becomes a free term, and the whole search is
    made again beside it: an effect is claimed only for what that term cannot explain, and none
    at the coordinate of the term itself.
    """
    found = _pursue(objective, library, progress)
    before = found.before
    free_terms: list[Unknown] = []
    for _ in range(MOST_BOXES):
        fresh = [u for u in found.unknown if u.kind in LINE_KINDS and u not in free_terms]
        if not fresh:
            break
        free_terms += fresh
        progress(
            f"no effect explains {', '.join(u.text for u in fresh)}: searching beside a free term"
        )
        beside = objective.beside(
            [free_term_basis(free_terms, travel) for travel in found.travels]
        )
        travel = found.travels[0]
        rest = [h for h in library if not explained_by_free_term(h, free_terms, travel)]
        found = _pursue(
            beside, rest, progress, sum(free_term.strength for free_term in free_terms)
        )
        more = [u for u in found.unknown if not any(u.like(free_term) for free_term in free_terms)]
        found.unknown = [*free_terms, *more]
        found.before = before  # with the line that is now a free term, for the report
    return found


def _pursue(
    objective: Objective, library: Sequence[Hypothesis], progress: Progress, aside: float = 0.0
) -> Selection:
    """Return the effects found one after another, and what is left then.

    ``aside`` is what free terms have taken up already.
    """
    objective, nominal = joint_refit(
        objective, nominal_fit(objective, synchronised_shifts(objective, {}))
    )
    nominal = synchronised(objective, nominal)
    travels = [
        travel_of(twin, measured, nominal.case, noise.first)
        for twin, measured, noise in zip(
            objective.pool.twins, objective.measured, objective.noise, strict=True
        )
    ]
    before = remaining_spectra(objective, nominal, travels)
    found = Selection(
        nominal=nominal, fit=nominal, travels=travels, before=before, after=before, aside=aside
    )
    for _ in range(MOST_EFFECTS):
        accepted = _search(objective, found, library, progress)
        if accepted is None:
            break
        steps, fit = accepted
        found.steps.extend(steps)
        progress("all numbers together, at the declared drive tick")
        objective, found.fit = joint_refit(objective, fit)
        found.after = remaining_spectra(objective, found.fit, travels)
        if _at_floor(objective, found):
            break
    found.unknown = unexplained_parts(objective, found.nominal, found.fit, found.after)
    if any(u.kind not in LINE_KINDS for u in found.unknown):
        _keep_lines_only(objective, found, progress)
    elif found.steps:
        found.corrections = total_shifts(objective, found.fit)
    return found


def _keep_lines_only(objective: Objective, found: Selection, progress: Progress) -> None:
    """Take back effects that are no lines when structure is left that is no line either.

    Without a coordinate of its own such an effect is known only by how well it fits: one that
    leaves more than noise has at best imitated the cause.
    """
    fit = found.fit
    kept = [k for k, h in enumerate(fit.hypotheses) if is_line(h, found)]
    if len(kept) == len(fit.hypotheses):
        return
    progress("structure is left that is no line: effects that are none are taken back")
    found.steps = [found.steps[k] for k in kept]
    rest = [(fit.hypotheses[k], fit.values[k]) for k in kept]
    found.fit = gauss_newton_fit(
        objective, [h for h, _ in rest], [v for _, v in rest], fit.shifts, rounds=4, coarse=False
    )
    found.after = remaining_spectra(objective, found.fit, found.travels)
    found.unknown = unexplained_parts(objective, found.nominal, found.fit, found.after)


def _search(
    objective: Objective, found: Selection, library: Sequence[Hypothesis], progress: Progress
) -> tuple[list[AcceptedEffect], Fit] | None:
    """Look among lines first when there is one, then among effects that are none.

    An effect that leaves much of its own line may be half of a pair: a second effect that is no
    line (a delay, a filter) can have changed how the line answers the first.
    """
    lines, others = with_line_support(library, found.travels, found.after)
    bounce = [h for h in lines if h.effect.name == "roll_bounce"]
    plain = [h for h in lines if h.effect.name != "roll_bounce"]
    progress(f"cost {found.fit.cost:.0f}, noise alone {objective.expected_cost:.0f}")
    half: tuple[AcceptedEffect, Fit] | None = None
    floor = min(objective.expected_cost, found.fit.cost - 225.0)
    names = frozenset(h.effect.name for h in library)
    pulled = _beyond_tolerance(objective, found, names, progress)
    full: tuple[AcceptedEffect, Fit] | None = None
    for group in (plain, bounce, others):
        accepted = _best_of(objective, found, group, progress, pulled if group is others else ())
        if accepted is None:
            continue
        if explains_own_lines(objective, found.fit, found.after, found.travels, accepted[1]):
            if full is None or accepted[1].cost < full[1].cost:
                full = accepted
            if found.fit.cost - accepted[1].cost > 0.3 * (found.fit.cost - floor):
                break
            continue
        progress("  leaves too much: not accepted alone")
        if not is_line(accepted[0].hypothesis, found):
            continue
        if half is None or accepted[1].cost < half[1].cost:
            half = accepted
    if full is not None and (half is None or full[1].cost < half[1].cost):
        return [full[0]], full[1]
    if half is None:
        return None
    second = _beside(objective, found, half, others, lines, progress)
    return None if second is None else ([half[0], second[0]], second[1])


def _beside(
    objective: Objective,
    found: Selection,
    half: tuple[AcceptedEffect, Fit],
    others: Sequence[Hypothesis],
    lines: Sequence[Hypothesis],
    progress: Progress,
) -> tuple[AcceptedEffect, Fit] | None:
    """Return the effect that, beside ``half``, leaves nothing of its line.

    One that is no line, or the same at another place: hum on two cells is one line in time.
    """
    name = half[0].hypothesis.effect.name
    progress(f"trying a second effect beside {name}")
    base = replace(found, fit=half[1], after=remaining_spectra(objective, half[1], found.travels))
    for group in (others, [h for h in lines if h.effect.name == name]):
        second = _best_of(objective, base, group, progress)
        if second is None:
            continue
        step, fit = second[0], profile_reinitialised(objective, second[1])
        if explains_own_lines(objective, found.fit, found.after, found.travels, fit):
            return step, fit
    return None


def _beyond_tolerance(
    objective: Objective, found: Selection, names: frozenset[str], progress: Progress
) -> list[FittedCandidate]:
    """Return fits (score, fit, effect) that say the same as a declared number beyond tolerance."""
    fits: list[FittedCandidate] = []
    for h, start, shifts in starts_outside_prior(objective, found.fit, frozenset(BY_NAME) - names):
        if h.key in {k.key for k in found.fit.hypotheses}:
            continue
        fit = with_effect(objective, found.fit, h, start, shifts)
        if fit is None:
            continue
        score = found.fit.cost - fit.cost - bic_penalty(objective, len(h.names))
        progress(f"  {h.effect.name} at {h.location}, beyond tolerance: score {score:.0f}")
        fits.append((score, fit, h))
    return fits


def _best_of(
    objective: Objective,
    found: Selection,
    candidates: Sequence[Hypothesis],
    progress: Progress,
    pulled: Sequence[FittedCandidate] = (),
) -> tuple[AcceptedEffect, Fit] | None:
    """Screen a group of hypotheses and fit the best; ``pulled`` are fits to compete with them."""
    taken = {h.key for h in found.fit.hypotheses}
    group = [h for h in candidates if h.key not in taken]
    if not group:
        return claim(objective, found, [], progress, pulled)
    line = objective.pool.twins[0].declaration
    idlers = [r.name if r.kind == "idler" else "" for r in line.rollers]
    residual = objective.residual(objective.pool.one(found.fit.case), found.fit.shifts)
    progress(f"  {len(group)} hypotheses")
    ranked = screen(objective, found.fit, every_third_idler(group, idlers), residual, found.fit)
    more = neighbours(group, ranked, idlers)
    if more:
        ranked += screen(objective, found.fit, more, residual, found.fit)
        ranked.sort(key=lambda s: -s.score)
    found.first_look.extend(ranked if not found.steps else [])
    return claim(objective, found, ranked, progress, pulled)


def _at_floor(objective: Objective, found: Selection) -> bool:
    """Return whether what is left is surely less than a further effect would have to explain.

    That is a share of what strong effects explained, for no model is exact; beside weak ones it
    is less than what noise is known to.
    """
    excess = found.fit.cost - objective.expected_cost
    return excess + cost_standard_deviation(objective) < DISCREPANCY * (
        found.nominal.cost - found.fit.cost
    )
