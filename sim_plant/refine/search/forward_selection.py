"""Trace a residual to effects, one after another, against generic terms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.fit.gauss_newton import Fit, empty_fit, refine_fit
from sim_plant.refine.fit.objective import Problem
from sim_plant.refine.fit.roll_synchronisation import in_step, stepped
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.search.completeness import complete, lines_left, unsure
from sim_plant.refine.search.effect_fit import fitted, reseated
from sim_plant.refine.search.free_terms import LINE_KINDS, free_lines, taken_up
from sim_plant.refine.search.outside_prior import pulled_starts, shifts_in_force
from sim_plant.refine.search.profile_detail import polished
from sim_plant.refine.search.screening import neighbours, price, screen, thinned, worth_trying
from sim_plant.refine.search.selection import DISCREPANCY, Rival, Say, Step, Trace, claim, is_line
from sim_plant.refine.search.unexplained import Unknown, unknowns
from sim_plant.refine.spectra.coordinates import travel_of

MOST_EFFECTS = 4
MOST_BOXES = 2


def trace(problem: Problem, library: Sequence[Hypothesis], say: Say) -> Trace:
    """Return effects that explain the records, and what remains unexplained.

    Where a line remains that no effect explains, it becomes a free term, and the whole search is
    made again beside it: an effect is claimed only for what that term cannot explain, and none
    at the coordinate of the term itself.
    """
    found = _pursue(problem, library, say)
    before = found.before
    boxes: list[Unknown] = []
    for _ in range(MOST_BOXES):
        fresh = [u for u in found.unknown if u.kind in LINE_KINDS and u not in boxes]
        if not fresh:
            break
        boxes += fresh
        say(f"no effect explains {', '.join(u.text for u in fresh)}: searching beside a free term")
        beside = problem.beside([free_lines(boxes, travel) for travel in found.travels])
        travel = found.travels[0]
        rest = [h for h in library if not taken_up(h, boxes, travel)]
        found = _pursue(beside, rest, say, sum(box.strength for box in boxes))
        more = [u for u in found.unknown if not any(u.like(box) for box in boxes)]
        found.unknown = [*boxes, *more]
        found.before = before  # with the line that is now a free term, for the report
    return found


def _pursue(
    problem: Problem, library: Sequence[Hypothesis], say: Say, aside: float = 0.0
) -> Trace:
    """Return the effects found one after another, and what is left then.

    ``aside`` is what free terms have taken up already.
    """
    problem, nominal = polished(problem, empty_fit(problem, in_step(problem, {})))
    nominal = stepped(problem, nominal)
    travels = [
        travel_of(twin, measured, nominal.case, noise.first)
        for twin, measured, noise in zip(
            problem.bench.twins, problem.measured, problem.noise, strict=True
        )
    ]
    before = lines_left(problem, nominal, travels)
    found = Trace(
        nominal=nominal, fit=nominal, travels=travels, before=before, after=before, aside=aside
    )
    for _ in range(MOST_EFFECTS):
        accepted = _search(problem, found, library, say)
        if accepted is None:
            break
        steps, fit = accepted
        found.steps.extend(steps)
        say("all numbers together, at the declared drive tick")
        problem, found.fit = polished(problem, fit)
        found.after = lines_left(problem, found.fit, travels)
        if _at_floor(problem, found):
            break
    found.unknown = unknowns(problem, found.nominal, found.fit, found.after)
    if any(u.kind not in LINE_KINDS for u in found.unknown):
        _keep_lines_only(problem, found, say)
    elif found.steps:
        found.corrections = shifts_in_force(problem, found.fit)
    return found


def _keep_lines_only(problem: Problem, found: Trace, say: Say) -> None:
    """Take back effects that are no lines when structure is left that is no line either.

    Without a coordinate of its own such an effect is known only by how well it fits: one that
    leaves more than noise has at best imitated the cause.
    """
    fit = found.fit
    kept = [k for k, h in enumerate(fit.hypotheses) if is_line(h, found)]
    if len(kept) == len(fit.hypotheses):
        return
    say("structure is left that is no line: effects that are none are taken back")
    found.steps = [found.steps[k] for k in kept]
    rest = [(fit.hypotheses[k], fit.values[k]) for k in kept]
    found.fit = refine_fit(
        problem, [h for h, _ in rest], [v for _, v in rest], fit.shifts, rounds=4, coarse=False
    )
    found.after = lines_left(problem, found.fit, found.travels)
    found.unknown = unknowns(problem, found.nominal, found.fit, found.after)


def _search(
    problem: Problem, found: Trace, library: Sequence[Hypothesis], say: Say
) -> tuple[list[Step], Fit] | None:
    """Look among lines first when there is one, then among effects that are none.

    An effect that leaves much of its own line may be half of a pair: a second effect that is no
    line (a delay, a filter) can have changed how the line answers the first.
    """
    lines, others = worth_trying(library, found.travels, found.after)
    resonant = [h for h in lines if h.effect.resonant]
    plain = [h for h in lines if not h.effect.resonant]
    say(f"cost {found.fit.cost:.0f}, noise alone {problem.expected_cost:.0f}")
    half: tuple[Step, Fit] | None = None
    floor = min(problem.expected_cost, found.fit.cost - 225.0)
    names = frozenset(h.effect.name for h in library)
    pulled = _beyond_tolerance(problem, found, names, say)
    full: tuple[Step, Fit] | None = None
    for group in (plain, resonant, others):
        accepted = _best_of(problem, found, group, say, pulled if group is others else ())
        if accepted is None:
            continue
        if complete(problem, found.fit, found.after, found.travels, accepted[1]):
            if full is None or accepted[1].cost < full[1].cost:
                full = accepted
            if found.fit.cost - accepted[1].cost > 0.3 * (found.fit.cost - floor):
                break
            continue
        say("  leaves too much: not accepted alone")
        if not is_line(accepted[0].hypothesis, found):
            continue
        if half is None or accepted[1].cost < half[1].cost:
            half = accepted
    if full is not None and (half is None or full[1].cost < half[1].cost):
        return [full[0]], full[1]
    if half is None:
        return None
    second = _beside(problem, found, half, others, lines, say)
    return None if second is None else ([half[0], second[0]], second[1])


def _beside(
    problem: Problem,
    found: Trace,
    half: tuple[Step, Fit],
    others: Sequence[Hypothesis],
    lines: Sequence[Hypothesis],
    say: Say,
) -> tuple[Step, Fit] | None:
    """Return the effect that, beside ``half``, leaves nothing of its line.

    One that is no line, or the same at another place: hum on two cells is one line in time.
    """
    name = half[0].hypothesis.effect.name
    say(f"trying a second effect beside {name}")
    base = replace(found, fit=half[1], after=lines_left(problem, half[1], found.travels))
    for group in (others, [h for h in lines if h.effect.name == name]):
        second = _best_of(problem, base, group, say)
        if second is None:
            continue
        step, fit = second[0], reseated(problem, second[1])
        if complete(problem, found.fit, found.after, found.travels, fit):
            return step, fit
    return None


def _beyond_tolerance(
    problem: Problem, found: Trace, names: frozenset[str], say: Say
) -> list[Rival]:
    """Return fits (score, fit, effect) that say the same as a declared number beyond tolerance."""
    fits: list[Rival] = []
    for h, start, shifts in pulled_starts(problem, found.fit, frozenset(BY_NAME) - names):
        if h.key in {k.key for k in found.fit.hypotheses}:
            continue
        fit = fitted(problem, found.fit, h, start, shifts)
        if fit is None:
            continue
        score = found.fit.cost - fit.cost - price(problem, len(h.names))
        say(f"  {h.key}, beyond tolerance: score {score:.0f}")
        fits.append((score, fit, h))
    return fits


def _best_of(
    problem: Problem,
    found: Trace,
    candidates: Sequence[Hypothesis],
    say: Say,
    pulled: Sequence[Rival] = (),
) -> tuple[Step, Fit] | None:
    """Screen a group of hypotheses and fit the best; ``pulled`` are fits to compete with them."""
    taken = {h.key for h in found.fit.hypotheses}
    group = [h for h in candidates if h.key not in taken]
    if not group:
        return claim(problem, found, [], say, pulled)
    line = problem.bench.twins[0].declaration
    idlers = [r.name if r.kind == "idler" else "" for r in line.rollers]
    residual = problem.residual(problem.bench.one(found.fit.case), found.fit.shifts)
    say(f"  {len(group)} hypotheses")
    ranked = screen(problem, found.fit, thinned(group, idlers), residual, found.fit)
    more = neighbours(group, ranked, idlers)
    if more:
        ranked += screen(problem, found.fit, more, residual, found.fit)
        ranked.sort(key=lambda s: -s.score)
    found.first_look.extend(ranked if not found.steps else [])
    return claim(problem, found, ranked, say, pulled)


def _at_floor(problem: Problem, found: Trace) -> bool:
    """Return whether what is left is surely less than a further effect would have to explain.

    That is a share of what strong effects explained, for no model is exact; beside weak ones it
    is less than what noise is known to.
    """
    excess = found.fit.cost - problem.expected_cost
    return excess + unsure(problem) < DISCREPANCY * (found.nominal.cost - found.fit.cost)
