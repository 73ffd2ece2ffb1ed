"""Where an event begins and in which shape, on grids, each point by a simulation of its own."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.effects.onset import FOREVER_S, HOLD_S, RISE_S
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit, gauss_newton_fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.model.hypotheses import with_number
from sim_plant.refine.search.candidate import Candidate, bic_penalty
from sim_plant.refine.search.distinct_events import moment_of
from sim_plant.refine.search.episodes import best_episodes
from sim_plant.refine.search.screening import sure_look

EVENTS = CRITERIA.search.events


def placed_anew(objective: Objective, fit: Fit) -> Fit:
    """Return the fit with each of its events where it explains most beside all else, if better.

    An event was placed while other effects were as fitted without it, and a Gauss-Newton step
    does not find a moment from seconds away: what is left there looks like a second event.
    """
    for k, h in enumerate(fit.hypotheses):
        if not h.moment_parameter:
            continue
        others = replace(
            fit,
            hypotheses=(*fit.hypotheses[:k], *fit.hypotheses[k + 1 :]),
            values=(*fit.values[:k], *fit.values[k + 1 :]),
        )
        residual = objective.residual(objective.pool.one(others.case), fit.shifts)
        seen = Candidate(hypothesis=h, chi2_reduction=0.0, penalty=0.0, start=fit.values[k])
        here = gauss_newton_fit(objective, fit.hypotheses, fit.values, fit.shifts, rounds=0)
        for there in placed(objective, others, [seen], residual):
            if there.hypothesis.names != h.names:
                continue
            moved = fit.with_effect_at(k, h, there.start)
            new = gauss_newton_fit(objective, moved.hypotheses, moved.values, fit.shifts)
            fit = new if new.cost < here.cost - EVENTS.least_chi2 else fit
    return fit


def with_moment_refined(objective: Objective, fit: Fit) -> Fit:
    """Return the fit with the moment of its last effect where it explains most near by, if better.

    Its first look was from the declared numbers: where a zone answers slowly those that are off
    move the moment by seconds. And from sample to sample the cost goes up and down by what noise
    does there: where the answer is quick Gauss-Newton steps end a few samples off.
    """
    h, at = fit.hypotheses[-1], len(fit.hypotheses) - 1
    if not h.moment_parameter:
        return fit
    others = fit.without_effect_at(at)
    residual = objective.residual(objective.pool.one(others.case), fit.shifts)
    best = Candidate(hypothesis=h, chi2_reduction=0.0, penalty=0.0, start=fit.values[at])
    for _ in range(EVENTS.passes):
        was, best = best, _best_moment(objective, others, best, residual, EVENTS.coarse_grid)
        if moment_of(best) == moment_of(was):
            break
    best = _best_moment(objective, others, best, residual, EVENTS.fine_grid)
    moved = fit.with_effect_at(at, h, best.start)
    new = gauss_newton_fit(objective, moved.hypotheses, moved.values, fit.shifts)
    return new if new.cost < fit.cost else fit


def placed(
    objective: Objective, fit: Fit, seen: Sequence[Candidate], residual: Array
) -> list[Candidate]:
    """Return candidates with their moment and shape parameters found on grids, best first."""
    found = []
    for c in seen:
        best, onset = c, c.hypothesis.effect.onset
        ends = c.hypothesis.is_episode
        for at in range(EVENTS.passes if onset is not None and onset.grid else 1):
            if ends:
                # the best moments depend on the place: each is tried with moments of its own
                ways = _ways(best, at)
                starts = [s for way in ways for s in best_episodes(objective, fit, way, residual)]
                best = _best_of_starts(objective, fit, best, residual, [best.start, *starts])
            else:
                best = _best_moment(objective, fit, best, residual, EVENTS.coarse_grid)
            shapes = () if onset is None else onset.grid[1:] if ends else onset.grid
            for name, values in shapes:
                if name in c.hypothesis.names and name != HOLD_S:
                    best = _best_of_shapes(objective, fit, best, residual, name, values)
        if not ends:
            best = _best_moment(objective, fit, best, residual, EVENTS.fine_grid)
        if best.score > EVENTS.least_chi2:
            found.append(_without_end(objective, best))
    return sorted(found, key=lambda c: -c.score)


def _ways(c: Candidate, halvings: int) -> list[Candidate]:
    """Return the candidate with each value of the first shape parameter of its grid.

    After ``halvings`` of the grid's step: with its own value, and one step to either side.
    """
    h, onset = c.hypothesis, c.hypothesis.effect.onset
    name, values = onset.grid[0] if onset is not None and onset.grid else ("", ())
    if name not in h.names:
        return [c]
    at = h.names.index(name)
    if halvings:
        step = 0.5**halvings * (values[1] - values[0])
        near = [c.start[at] + k * step for k in (-1, 0, 1)]
        values = tuple(v for v in near if h.low[at] <= v <= h.high[at])
    return [replace(c, start=with_number(h, c.start, name, value)) for value in values]


def _best_moment(
    objective: Objective, fit: Fit, c: Candidate, residual: Array, grid: Sequence[float]
) -> Candidate:
    """Return the candidate at its best moment; ``grid`` are steps from the one it has."""
    moments = [max(0.0, moment_of(c) + d) for d in grid]
    starts = [
        with_number(c.hypothesis, c.start, c.hypothesis.moment_parameter, m) for m in moments
    ]
    return _best_of_starts(objective, fit, c, residual, starts)


def _best_of_shapes(
    objective: Objective,
    fit: Fit,
    c: Candidate,
    residual: Array,
    name: str,
    values: Sequence[float],
) -> Candidate:
    """Return the candidate with the best of ``values`` of a shape parameter, or its own."""
    h = c.hypothesis
    starts = [with_number(h, c.start, name, value) for value in values]
    if name == RISE_S:  # the middle of the rise stays: the moment was found by it
        rise_s = c.start[h.names.index(RISE_S)]
        begun = [max(0.0, moment_of(c) - 0.5 * (value - rise_s)) for value in values]
        starts = [
            with_number(h, s, h.moment_parameter, m) for s, m in zip(starts, begun, strict=True)
        ]
    return _best_of_starts(objective, fit, c, residual, [c.start, *starts])


def _best_of_starts(
    objective: Objective,
    fit: Fit,
    c: Candidate,
    residual: Array,
    starts: Sequence[tuple[float, ...]],
) -> Candidate:
    """Return the candidate at the start whose strengths explain most, by one linear step each."""
    h = c.hypothesis
    typical = h.start[: h.strength_count]
    tried = [replace(h, start=(*typical, *s[h.strength_count :])) for s in dict.fromkeys(starts)]
    cases = [
        replace(fit.case, effects=(*fit.case.effects, added))
        for each in tried
        for added in each.start_effects()
    ]
    base, *runs = objective.pool.run([fit.case, *cases], keep=False)
    best = replace(c, chi2_reduction=-math.inf)
    penalty = bic_penalty(objective, len(h.names)) + EVENTS.moment_penalty
    every = objective.columns(runs, base, np.ones(len(runs)))
    parts = np.split(every, len(tried), axis=1)
    known = [k for k, columns in enumerate(parts) if np.isfinite(columns).all()]
    inners = objective.projector.inners(residual, [parts[k] for k in known])
    best_look: tuple[Candidate, Array] | None = None
    for k, inner in zip(known, inners, strict=True):
        each, columns, linear = tried[k], parts[k], inner.fit()
        if linear.chi2_reduction > best.chi2_reduction:
            sizes = tuple(
                float(np.clip(a + v * (s - a), lo, hi))
                for a, s, v, lo, hi in zip(
                    h.absent, typical, linear.values, h.low, h.high, strict=False
                )
            )
            best = replace(
                c,
                chi2_reduction=linear.chi2_reduction,
                penalty=penalty,
                start=(*sizes, *each.start[h.strength_count :]),
            )
            best_look = replace(best, hypothesis=each), columns
    if best_look is None:
        return best
    left = objective.projector.project(residual)
    sure = sure_look(objective, left, objective.quantisation_chi2(left), *best_look)
    return replace(best, chi2_reduction=sure.chi2_reduction)


def _without_end(objective: Objective, c: Candidate) -> Candidate:
    """Return the candidate without ``hold_s`` where that is forever: the effect does not end."""
    h = c.hypothesis
    sizes = enumerate(zip(h.names, c.start, strict=True))
    keep = [k for k, (name, value) in sizes if name != HOLD_S or value < FOREVER_S]
    if len(keep) == len(h.names):
        return c

    def pick(row: tuple[float, ...]) -> tuple[float, ...]:
        return tuple(row[k] for k in keep)

    fewer = replace(
        h,
        names=tuple(h.names[k] for k in keep),
        start=pick(h.start),
        absent=pick(h.absent),
        low=pick(h.low),
        high=pick(h.high),
    )
    penalty = bic_penalty(objective, len(keep)) + EVENTS.moment_penalty
    return replace(c, hypothesis=fewer, start=pick(c.start), penalty=penalty)
