"""Effects that begin at a moment: found by a matched filter, then on a grid of moments.

They are neither periodic nor constant; among periodic effects they would be taken for a slow one.
A shape parameter is a number of an effect that is no strength (a rise, a hold, a place in a zone).
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.effects.onset import FOREVER_S, HOLD_S, RISE_S
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit, gauss_newton_fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.fit.projection import AT_ONCE
from sim_plant.refine.model.hypotheses import Hypothesis, onset_hypotheses, with_number
from sim_plant.refine.search.candidate import Candidate, Progress, bic_penalty
from sim_plant.refine.search.distinct_events import distinct, moment_of
from sim_plant.refine.search.episodes import best_episodes, ended_again
from sim_plant.refine.search.like_idlers import LikeIdlers
from sim_plant.refine.search.screening import sensitivities, sure_look
from sim_plant.refine.search.shifted_responses import hypothesis_beginning_at, response_begun_at
from sim_plant.refine.spectra.moment_axis import MomentAxis, moment_axis, parts_of, resampled
from sim_plant.refine.spectra.onset_filter import best_moments

EVENTS = CRITERIA.search.events
Start = tuple[float, ...]


def event_candidates(
    objective: Objective,
    fit: Fit,
    without: Collection[str],
    progress: Progress,
    least_score: float = 0.0,
) -> list[Candidate]:
    """Return effects that begin at a moment of a record, best first, with numbers to start from.

    ``without`` are names left out of the library, ``least_score`` is what acceptance will need.
    """
    candidates: list[Candidate] = []
    for record, twin in enumerate(objective.pool.twins):
        library = onset_hypotheses(twin.declaration, record, without)
        like = LikeIdlers.of(library, twin.declaration)
        group = like.thinned(library)
        residual = objective.residual(objective.pool.one(fit.case), fit.shifts)
        white = objective.split(objective.projector.project(residual))[record]
        noise = objective.whitening.noise[record]
        white = white[noise.analogue]  # steps of coarse words wander, like an event
        units = {onset.unit for h in group if (onset := h.effect.onset) is not None}
        axes: dict[str, MomentAxis] = {
            unit: moment_axis(twin, noise.first, unit) for unit in units
        }
        on_grid = {unit: resampled(white, a.moments, a.grid) for unit, a in axes.items()}
        seen = [
            c
            for h in group
            for shaped in _shapes_of(h)
            for c in _by_matched_filter(objective, fit, shaped, axes, on_grid)
        ]
        seen = _weighed_at_their_moments(objective, group, seen, axes, residual)
        seen.sort(key=lambda c: -c.score)
        tried = _placed(objective, fit, distinct(seen, least_score), residual)
        near = like.neighbours(library, tried)
        starts = {c.hypothesis.effect.name: c.start for c in reversed(tried)}
        beside = [
            Candidate(hypothesis=h, chi2_reduction=0.0, penalty=0.0, start=starts[h.effect.name])
            for h in near
            if len(starts.get(h.effect.name, ())) == len(h.names)
        ]
        candidates += [*tried, *_placed(objective, fit, beside, residual)]
    candidates.sort(key=lambda c: -c.score)
    for c in candidates[: EVENTS.most_told]:
        progress(f"  {c.hypothesis.key} from {moment_of(c):.2f}: score {c.score:.0f}")
    return candidates


def placed_anew(objective: Objective, fit: Fit) -> Fit:
    """Return the fit with each of its events where it explains most beside all else, if better.

    An event was placed while other effects were as fitted without it, and a Gauss-Newton step
    does not find a moment from seconds away: what is left there looks like a second event.
    """
    for k, h in enumerate(fit.hypotheses):
        if not h.moment:
            continue
        others = replace(
            fit,
            hypotheses=(*fit.hypotheses[:k], *fit.hypotheses[k + 1 :]),
            values=(*fit.values[:k], *fit.values[k + 1 :]),
        )
        residual = objective.residual(objective.pool.one(others.case), fit.shifts)
        seen = Candidate(hypothesis=h, chi2_reduction=0.0, penalty=0.0, start=fit.values[k])
        here = gauss_newton_fit(objective, fit.hypotheses, fit.values, fit.shifts, rounds=0)
        for there in _placed(objective, others, [seen], residual):
            if there.hypothesis.names != h.names:
                continue
            moved = fit.with_effect_at(k, h, there.start)
            new = gauss_newton_fit(objective, moved.hypotheses, moved.values, fit.shifts)
            fit = new if new.cost < here.cost - EVENTS.least_chi2 else fit
    return fit


def _shapes_of(h: Hypothesis) -> list[Hypothesis]:
    """Return the hypothesis with each value of the first shape parameter of its grid."""
    onset = h.effect.onset
    name, values = onset.grid[0] if onset is not None and onset.grid else ("", ())
    if name not in h.names:
        return [h]
    return [replace(h, start=with_number(h, h.start, name, value)) for value in values]


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


def _by_matched_filter(
    objective: Objective,
    fit: Fit,
    h: Hypothesis,
    axes: Mapping[str, MomentAxis],
    on_grid: Mapping[str, Array],
) -> list[Candidate]:
    """Return the best moments of one effect, by a response simulated once per part of the axis."""
    onset = h.effect.onset
    if onset is None:
        return []
    axis, white = axes[onset.unit], on_grid[onset.unit]
    parts = parts_of(axis)
    columns = sensitivities(
        objective, fit, [hypothesis_beginning_at(h, part.middle) for part in parts]
    )
    candidates: list[Candidate] = []
    for part, column in zip(parts, columns, strict=True):
        if not np.isfinite(column).all():
            continue
        record = h.record_index or 0
        response = objective.split(column[:, 0])[record]
        response = response[objective.whitening.noise[record].analogue]
        for chi2, moment in best_moments(axis, white, response, part, onset.unit):
            start = hypothesis_beginning_at(h, moment).start
            candidates.append(
                Candidate(hypothesis=h, chi2_reduction=chi2, penalty=0.0, start=start)
            )
    return candidates


def _weighed_at_their_moments(
    objective: Objective,
    group: Sequence[Hypothesis],
    seen: Sequence[Candidate],
    axes: Mapping[str, MomentAxis],
    residual: Array,
) -> list[Candidate]:
    """Return what the matched filter found, each response weighed at its own moment.

    A response that lasts for the rest of a record explains otherwise at each moment: drift and
    tolerances imitate a step at the end, not one in the middle. So the best places of every effect
    are tried over the whole record too, and all its places at the best moment of those.
    """
    candidates: list[Candidate] = []
    for name in dict.fromkeys(c.hypothesis.effect.name for c in seen):
        mine = sorted(
            (c for c in seen if c.hypothesis.effect.name == name), key=lambda c: -c.score
        )
        onset = mine[0].hypothesis.effect.onset
        if onset is None or onset.unit != "s":
            candidates += mine
            continue
        axis, shown = axes[onset.unit], mine[: EVENTS.most_places]
        best = _over_the_record(objective, axis, shown, residual)
        looks = [(c.hypothesis, moment_of(c)) for c in shown]
        looks += [
            (shaped, moment_of(best))
            for h in group
            if h.effect.name == name
            for shaped in _shapes_of(h)
        ]
        candidates += _shifted(objective, axis, looks, residual)
        candidates += ended_again(objective, axis, shown, residual)
    return candidates


def _over_the_record(
    objective: Objective, axis: MomentAxis, shown: Sequence[Candidate], residual: Array
) -> Candidate:
    """Return the best moment of the places in ``shown``, on a wide grid, then on a closer one."""
    places = {c.hypothesis.key: c.hypothesis for c in reversed(shown)}.values()
    grid = axis.grid
    wide = np.arange(grid[0] + EVENTS.wide_step_s, grid[-1], EVENTS.wide_step_s)
    looks = [(h, float(m)) for h in places for m in wide]
    best = max(_shifted(objective, axis, looks, residual), key=lambda c: c.score)
    close = moment_of(best) + EVENTS.apart * np.linspace(-1.5, 1.5, 7)
    inside = close[(close > grid[0]) & (close < grid[-1])]
    more = _shifted(objective, axis, [(best.hypothesis, float(m)) for m in inside], residual)
    return max((best, *more), key=lambda c: c.score)


def _shifted(
    objective: Objective,
    axis: MomentAxis,
    looks: Sequence[tuple[Hypothesis, float]],
    residual: Array,
) -> list[Candidate]:
    """Return candidates of ``looks`` (effect, moment in s), by the nearest responses simulated."""
    found: list[Candidate] = []
    for at in range(0, len(looks), AT_ONCE):
        some = looks[at : at + AT_ONCE]
        columns = objective.whitened_all(
            [response_begun_at(objective, axis, h, m) for h, m in some]
        )
        explained = objective.projector.explained(residual, columns)
        rows = zip(some, explained, strict=True)
        found += [
            Candidate(
                hypothesis=h,
                chi2_reduction=float(chi2),
                penalty=0.0,
                start=hypothesis_beginning_at(h, moment).start,
            )
            for (h, moment), chi2 in rows
        ]
    return found


def _placed(
    objective: Objective, fit: Fit, seen: Sequence[Candidate], residual: Array
) -> list[Candidate]:
    """Return candidates with their moment and shape parameters found on grids, best first."""
    placed = []
    for c in seen:
        best, onset = c, c.hypothesis.effect.onset
        ends = HOLD_S in c.hypothesis.names
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
            placed.append(_without_end(objective, best))
    return sorted(placed, key=lambda c: -c.score)


def _best_moment(
    objective: Objective, fit: Fit, c: Candidate, residual: Array, grid: Sequence[float]
) -> Candidate:
    """Return the candidate at its best moment; ``grid`` are steps from the one it has."""
    moments = [max(0.0, moment_of(c) + d) for d in grid]
    starts = [with_number(c.hypothesis, c.start, c.hypothesis.moment, m) for m in moments]
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
        starts = [with_number(h, s, h.moment, m) for s, m in zip(starts, begun, strict=True)]
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
    typical = h.start[: h.strengths]
    tried = [replace(h, start=(*typical, *s[h.strengths :])) for s in dict.fromkeys(starts)]
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
                start=(*sizes, *each.start[h.strengths :]),
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
