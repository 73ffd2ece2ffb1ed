"""Effects that begin at a moment: found by a matched filter, then on a grid of moments.

They are neither periodic nor constant; among periodic effects they would be taken for a slow one.
A shape parameter is a number of an effect that is no strength (a rise, a hold, a place in a zone).
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.fit.projection import AT_ONCE
from sim_plant.refine.model.hypotheses import Hypothesis, onset_hypotheses, with_number
from sim_plant.refine.search.candidate import Candidate, Progress
from sim_plant.refine.search.distinct_events import distinct, moment_of
from sim_plant.refine.search.episodes import ended_again
from sim_plant.refine.search.known_moments import OF_NUMBERS, axis_of, moments_known
from sim_plant.refine.search.like_idlers import LikeIdlers
from sim_plant.refine.search.placed_events import placed
from sim_plant.refine.search.screening import sensitivities, simulate_responses
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
        numbers = [h for h in group if h.effect.shifted_by]
        group = [h for h in group if not h.effect.shifted_by]
        seen = _by_matched_filters(objective, fit, group, axes, white)
        moments = moments_known(seen, white, noise.first, twin.declaration.sample_time_s)
        if numbers and moments:
            group += numbers
            axes[OF_NUMBERS] = replace(axes["s"], looked_at=moments)
            seen += _by_matched_filters(objective, fit, numbers, axes, white)
        seen = _weighed_at_their_moments(objective, group, seen, axes, residual)
        seen.sort(key=lambda c: -c.score)
        tried = placed(objective, fit, distinct(seen, least_score), residual)
        near = like.neighbours(library, tried)
        starts = {c.hypothesis.effect.name: c.start for c in reversed(tried)}
        beside = [
            Candidate(hypothesis=h, chi2_reduction=0.0, penalty=0.0, start=starts[h.effect.name])
            for h in near
            if len(starts.get(h.effect.name, ())) == len(h.names)
        ]
        candidates += [*tried, *placed(objective, fit, beside, residual)]
    candidates.sort(key=lambda c: -c.score)
    for c in candidates[: EVENTS.most_told]:
        progress(f"  {c.hypothesis.key} from {moment_of(c):.2f}: score {c.score:.0f}")
    return candidates


def _shapes_of(h: Hypothesis) -> list[Hypothesis]:
    """Return the hypothesis with each value of the first shape parameter of its grid."""
    onset = h.effect.onset
    name, values = onset.grid[0] if onset is not None and onset.grid else ("", ())
    if name not in h.names:
        return [h]
    return [replace(h, start=with_number(h, h.start, name, value)) for value in values]


def _by_matched_filters(
    objective: Objective,
    fit: Fit,
    group: Sequence[Hypothesis],
    axes: Mapping[str, MomentAxis],
    white: Array,
) -> list[Candidate]:
    """Return the best moments of each effect of a group in each shape; ``white``: what is left."""
    shapes = [(shaped, axes[axis_of(h)]) for h in group for shaped in _shapes_of(h)]
    begun = [hypothesis_beginning_at(h, part.middle) for h, a in shapes for part in parts_of(a)]
    simulate_responses(objective, fit, begun)
    keys = {axis_of(h) for h in group}
    on_grid = {key: resampled(white, axes[key].moments, axes[key].grid) for key in keys}
    return [
        c
        for shaped, axis in shapes
        for c in _by_matched_filter(objective, fit, shaped, axis, on_grid[axis_of(shaped)])
    ]


def _by_matched_filter(
    objective: Objective, fit: Fit, h: Hypothesis, axis: MomentAxis, on_grid: Array
) -> list[Candidate]:
    """Return the best moments of one effect, by a response simulated once per part of the axis."""
    onset = h.effect.onset
    if onset is None:
        return []
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
        for chi2, moment in best_moments(axis, on_grid, response, part, onset.unit):
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
        axis, shown = axes[axis_of(mine[0].hypothesis)], mine[: EVENTS.most_places]
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
    close = moment_of(best) + EVENTS.apart * np.array(EVENTS.around)
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
