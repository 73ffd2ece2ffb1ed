"""Trace a residual to effects, one after another, against generic terms."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.blackbox import LINE_KINDS, free_lines
from sim_plant.refine.completeness import complete, lines_left
from sim_plant.refine.coordinates import Travel, line_support, travel_of
from sim_plant.refine.details import polished
from sim_plant.refine.equivalents import within_tolerance
from sim_plant.refine.fit import Fit, empty_fit, felt_radii, refine_fit
from sim_plant.refine.generic import LineSpectrum
from sim_plant.refine.hypotheses import Hypothesis
from sim_plant.refine.problem import Problem
from sim_plant.refine.pulled import pulled_starts, shifts_in_force
from sim_plant.refine.screen import Scored, neighbours, price, screen, thinned, worth_trying
from sim_plant.refine.shapes import EFFECT as OUT_OF_ROUND
from sim_plant.refine.shapes import profile_starts
from sim_plant.refine.unknown import Unknown, unknowns

MOST_EFFECTS = 4
MOST_BOXES = 2
SCORE_THRESHOLD = 120.0
"""Effects that are no lines: healthy records of other code, and line01, reach 85 to 115."""
LINE_SCORE = 50.0
"""An effect with a coordinate of its own needs less: what a model lacks seldom has the same."""
BEYOND_DOUBT = 3000.0
"""A score above this needs no second look at the declared drive tick."""
WEAK = 150.0
"""An effect without a line is not claimed below this when another explains nearly as much."""
MARGIN = 10.0
"""Effects whose scores are closer than this cannot be told apart."""
MOST_LOOKS = 5
RUNNERS = 4
DISCREPANCY = 0.006
"""A further effect must explain more than this share of what was explained: no model is exact."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Step:
    """One accepted effect, and what it was chosen against."""

    hypothesis: Hypothesis
    score: float
    runner_up: str
    margin: float
    rejected: tuple[tuple[str, str, float], ...]  # effect, location, score
    ambiguous: tuple[tuple[str, str], ...] = ()


@dataclass(slots=True, kw_only=True, eq=False)
class Trace:
    """Everything the search found.

    ``corrections`` are the declared numbers as re-estimated with the effects, by path: none where
    structure is left that is no line, for they may then have imitated it.
    """

    nominal: Fit
    fit: Fit
    travels: list[Travel]
    before: list[list[LineSpectrum]]
    after: list[list[LineSpectrum]]
    steps: list[Step] = field(default_factory=list)
    unknown: list[Unknown] = field(default_factory=list)
    corrections: dict[str, float] = field(default_factory=dict)
    first_look: list[Scored] = field(default_factory=list)


Say = Callable[[str], None]


def trace(problem: Problem, library: Sequence[Hypothesis], say: Say) -> Trace:
    """Return effects that explain the records, and what remains unexplained.

    Where a line remains that no effect explains, it becomes a free term, and the whole search is
    made again beside it: an effect is claimed only for what that term cannot explain.
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
        found = _pursue(beside, library, say)
        more = [u for u in found.unknown if not any(u.like(box) for box in boxes)]
        found.unknown = [*boxes, *more]
        found.before = before  # with the line that is now a free term, for the report
    return found


def _pursue(problem: Problem, library: Sequence[Hypothesis], say: Say) -> Trace:
    """Return the effects found one after another, and what is left then."""
    nominal = empty_fit(problem, felt_radii(problem))
    problem, nominal = polished(problem, nominal)
    travels = [
        travel_of(twin, measured, nominal.case, noise.first)
        for twin, measured, noise in zip(
            problem.bench.twins, problem.measured, problem.noise, strict=True
        )
    ]
    before = lines_left(problem, nominal, travels)
    found = Trace(nominal=nominal, fit=nominal, travels=travels, before=before, after=before)
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


def is_line(h: Hypothesis, found: Trace) -> bool:
    """Return whether a hypothesis shows at a coordinate of its own."""
    return line_support(h, found.travels[0], found.before[0]) is not None


def _search(
    problem: Problem, found: Trace, library: Sequence[Hypothesis], say: Say
) -> tuple[list[Step], Fit] | None:
    """Look among lines first when there is one, then among effects that are none.

    An effect that leaves much of its own line may be half of a pair: a second effect that is no
    line (a delay, a filter) can have changed how the line answers the first.
    """
    lines, others = worth_trying(library, found.travels, found.after)
    bounce = [h for h in lines if h.effect.name == "roll_bounce"]
    plain = [h for h in lines if h.effect.name != "roll_bounce"]
    say(f"cost {found.fit.cost:.0f}, noise alone {problem.expected_cost:.0f}")
    half: tuple[Step, Fit] | None = None
    floor = min(problem.expected_cost, found.fit.cost - 225.0)
    names = frozenset(h.effect.name for h in library)
    pulled = _beyond_tolerance(problem, found, names, say)
    full: tuple[Step, Fit] | None = None
    for group in (plain, bounce, others):
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
    if full is not None:
        return [full[0]], full[1]
    if half is None:
        return None
    say(f"trying a second effect beside {half[0].hypothesis.effect.name}")
    base = replace(found, fit=half[1], after=lines_left(problem, half[1], found.travels))
    second = _best_of(problem, base, others, say)
    if second is not None and complete(problem, found.fit, found.after, found.travels, second[1]):
        return [half[0], second[0]], second[1]
    return None


_Rival = tuple[float, Fit, Hypothesis]


def _beyond_tolerance(
    problem: Problem, found: Trace, names: frozenset[str], say: Say
) -> list[_Rival]:
    """Return fits (score, fit, effect) that say the same as a declared number beyond tolerance."""
    fits: list[_Rival] = []
    for h, start, shifts in pulled_starts(problem, found.fit, frozenset(BY_NAME) - names):
        if h.key in {k.key for k in found.fit.hypotheses}:
            continue
        fit = _fitted(problem, found.fit, h, start, shifts)
        if fit is None:
            continue
        score = found.fit.cost - fit.cost - price(problem, len(h.names))
        say(f"  {h.effect.name} at {h.location}, beyond tolerance: score {score:.0f}")
        fits.append((score, fit, h))
    return fits


def _best_of(
    problem: Problem, found: Trace, candidates: Sequence[Hypothesis], say: Say,
    pulled: Sequence[_Rival] = (),
) -> tuple[Step, Fit] | None:  # fmt: skip
    """Screen a group of hypotheses and fit the best; ``pulled`` are fits to compete with them."""
    taken = {h.key for h in found.fit.hypotheses}
    group = [h for h in candidates if h.key not in taken]
    if not group:
        return _next(problem, found, [], say, pulled)
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
    return _next(problem, found, ranked, say, pulled)


def _at_floor(problem: Problem, found: Trace) -> bool:
    """Return whether what is left is a share no model explains: noise is known to a percent."""
    excess = found.fit.cost - problem.expected_cost
    return excess < DISCREPANCY * (found.nominal.cost - found.fit.cost)


def _shortlist(ranked: Sequence[Scored]) -> list[Scored]:
    """Return the best few of distinct effect and place; curved ones get a second chance."""
    best = ranked[0].score if ranked else 0.0
    kept: list[Scored] = []
    for s in ranked:
        curved = not all(s.hypothesis.linear)
        share = 0.25 if curved else 0.85
        if s.score < max(0.5 * LINE_SCORE, share * best):
            continue
        same = [k for k in kept if k.hypothesis.key == s.hypothesis.key]
        effect = [k for k in kept if k.hypothesis.effect.name == s.hypothesis.effect.name]
        if same or len(effect) >= 3:
            continue
        kept.append(s)
    return kept[: RUNNERS + 2]


def _next(
    problem: Problem, found: Trace, ranked: list[Scored], say: Say, pulled: Sequence[_Rival] = ()
) -> tuple[Step, Fit] | None:
    """Return the effect that explains most, fitted, or None when none may be claimed."""
    fits = list(pulled)
    for s in _shortlist(ranked):
        fit = _fit_one(problem, found.fit, s)
        if fit is None:
            continue
        h = fit.hypotheses[-1]
        score = found.fit.cost - fit.cost - price(problem, len(h.names))
        say(f"  {h.effect.name} at {h.location}: score {score:.0f}")
        fits.append((score, fit, h))
    fits = sorted((row for row in fits if np.isfinite(row[0])), key=lambda row: -row[0])
    fits = [row for k, row in enumerate(fits) if row[2].key not in {f[2].key for f in fits[:k]}]
    fits = _looked_at_again(problem, found, fits, say)
    if not fits:
        return None
    score, fit, h = fits[0]
    if score < _least(found, h):
        return None
    others = [(s, k) for s, _, k in fits[1:] if k.key != h.key]
    others += [(s.score, s.hypothesis) for s in ranked
               if s.hypothesis.key not in {k.key for _, _, k in fits}]  # fmt: skip
    others.sort(key=lambda row: -row[0])
    runner, second = (others[0][1], others[0][0]) if others else (None, 0.0)
    if runner and score < WEAK and score - second < MARGIN and not is_line(h, found):
        say(f"  {h.effect.name} at {h.location}: weak, and not to be told from "
            f"{runner.effect.name} at {runner.location}")  # fmt: skip
        return None
    say(f"  best: {h.effect.name} at {h.location}, score {score:.0f}")
    step = Step(
        hypothesis=h, score=score, runner_up=" at ".join(runner.key) if runner else "",
        margin=score - max(second, 0.0),
        rejected=tuple((k.effect.name, k.location, s) for s, k in others[:12]),
        ambiguous=tuple(k.key for s, k in others if score - s < MARGIN),
    )  # fmt: skip
    return step, fit


def _least(found: Trace, h: Hypothesis) -> float:
    explained = found.nominal.cost - found.fit.cost
    return max(LINE_SCORE if is_line(h, found) else SCORE_THRESHOLD, DISCREPANCY * explained)


def _looked_at_again(
    problem: Problem, found: Trace, fits: Sequence[_Rival], say: Say
) -> list[_Rival]:
    """Return the fits with small scores put right by what is lost without the effect, best first.

    One that is not missed makes room for the next; those that come near the best are looked at
    as well, so that a margin is between like and like.
    """
    again: list[_Rival] = []
    best = 0.0
    for raw, fit, h in fits:
        least = _least(found, h)
        if raw < max(least, best - MARGIN) or len(again) == MOST_LOOKS:
            break
        score = raw
        if raw < BEYOND_DOUBT:
            score = min(raw, _missed(problem, fit) - price(problem, len(h.names)))
            if score < least:
                say(f"  {h.effect.name} at {h.location}: not missed when all else is fitted again")
        again.append((score, fit, h))
        best = max(best, score)
    rest = [(min(raw, best) if again else raw, fit, h) for raw, fit, h in fits[len(again) :]]
    return sorted([*again, *rest], key=lambda row: -row[0])


def _missed(problem: Problem, fit: Fit) -> float:
    """Return how much the cost rises without the last effect, all else fitted anew from here.

    Both at the declared drive tick. A fit that was made again finds a better place for the
    declared numbers too, and a coarse tick moves the speed at which a quantised loop rests:
    those shares are not the effect's.
    """
    there = refine_fit(problem, fit.hypotheses, fit.values, fit.shifts, rounds=4, coarse=False)
    gone = refine_fit(
        problem, fit.hypotheses[:-1], there.values[:-1], there.shifts, rounds=4, coarse=False
    )
    return gone.cost - there.cost


def _fit_one(problem: Problem, fit: Fit, scored: Scored) -> Fit | None:
    h = scored.hypothesis
    if h.effect.name != OUT_OF_ROUND:
        return _fitted(problem, fit, h, scored.start, fit.shifts)
    own = f"rollers.{h.location}.effective_radius"  # a profile brings its own mean radius
    shifts = {name: value for name, value in fit.shifts.items() if name != own}
    best: Fit | None = None
    for hyp, start in _profiles(problem, fit, h):
        new = _fitted(problem, fit, hyp, start, shifts)
        if new is not None and (best is None or _worth(problem, new) < _worth(problem, best)):
            best = new
    excess = fit.cost - problem.expected_cost
    if best is None or fit.cost - best.cost < 0.9 * excess:
        free = _fitted(problem, fit, *scored.trimmed(), fit.shifts, rounds=2)
        if free is not None and (best is None or _worth(problem, free) < _worth(problem, best)):
            best = free
    return best


def _fitted(
    problem: Problem, fit: Fit, h: Hypothesis, start: Sequence[float], shifts: dict[str, float],
    rounds: int = 6,
) -> Fit | None:  # fmt: skip
    new = refine_fit(
        problem, (*fit.hypotheses, h), (*fit.values, tuple(start)), shifts, rounds=rounds
    )
    h, found, line = new.hypotheses[-1], new.values[-1], problem.bench.twins[0].declaration
    if not np.isfinite(new.cost) or h.at_bound(found):
        return None
    return None if within_tolerance(line, problem.nuisances, h, found) else new


def _worth(problem: Problem, fit: Fit) -> float:
    return fit.cost + price(problem, len(fit.hypotheses[-1].names))


def _profiles(
    problem: Problem, fit: Fit, h: Hypothesis
) -> list[tuple[Hypothesis, tuple[float, ...]]]:
    case = fit.case
    runs = problem.bench.run(
        [case, *(replace(case, effects=(*case.effects, a)) for a in h.probes())]
    )
    columns = np.stack([problem.column(r, runs[0], 1.0) for r in runs[1:]], axis=1)
    residual = problem.residual(runs[0], fit.shifts)
    cut = problem.projector.project(columns)
    line = problem.bench.twins[0].declaration
    radius = line.rollers[line.body(h.location)].radius_m
    inner: Array = columns.T @ cut
    return profile_starts(h.location, radius, inner, cut.T @ residual, h.start)
