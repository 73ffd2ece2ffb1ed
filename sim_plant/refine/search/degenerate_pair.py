"""Two rollers of one radius: whether they explain as much as one between them, and which do most.

Rollers of one radius make one spectral line in web travel; only its phase and size along the web
depend on the place, and how it changes with speed on what is wrong with the roller. Two such
rollers, both a little out of true or of balance, look like a third between them.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.model.hypotheses import Hypothesis, hypothesis, variants
from sim_plant.refine.search.candidate import Candidate, bic_penalty
from sim_plant.refine.search.screening import sensitivities
from sim_plant.refine.spectra.coordinates import RecordAxes, wavenumbers_1_m

DEGENERACY = CRITERIA.search.degeneracy


def better_pair(
    objective: Objective,
    fit: Fit,
    axes: RecordAxes,
    chosen: Hypothesis,
    candidates: Sequence[Candidate],
) -> tuple[EffectAt, ...]:
    """Return two places that together explain more than ``chosen``, or nothing.

    Pairs and ``chosen`` are weighed by one linear step, each number at its price; ``candidates``
    are first looks at ``fit``.
    """
    alone = [c for c in candidates if c.hypothesis.key == chosen.key]
    others = [c.hypothesis for c in candidates if same_wavenumbers(axes, chosen, c.hypothesis)]
    others = others[: DEGENERACY.most_places]
    if not alone or len(others) < 2:
        return ()
    ranked = pairs_by_score(objective, fit, others)
    if not ranked or ranked[0][0] <= alone[0].score:
        return ()
    return tuple(others[k].key for k in ranked[0][1])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BestPair:
    """Two effects of one wavenumber that together explain most.

    Attributes
    ----------
    two : the one that explains more alone first.
    behind : for each of them the others in its place, and by how much the pair's score is then
        behind, the least first.
    """

    two: tuple[Hypothesis, Hypothesis]
    behind: tuple[tuple[tuple[EffectAt, float], ...], ...]


def best_pair(objective: Objective, fit: Fit, hypotheses: Sequence[Hypothesis]) -> BestPair | None:
    """Return the two of ``hypotheses`` that together explain most of what ``fit`` leaves.

    By one linear step. None of fewer than two places, or where no two pay for their numbers.
    """
    taken = {h.key for h in fit.hypotheses}
    first_of = {h.key: h for h in reversed(hypotheses) if h.key not in taken}
    tried = list(first_of.values())
    if len(tried) < 2:
        return None
    ranked = pairs_by_score(objective, fit, tried)
    if not ranked or ranked[0][0] <= 0.0:
        return None
    score, (one, other) = ranked[0]
    behind = [
        tuple(
            (tried[k].key, score - less)
            for less, pair in ranked[1:]
            if kept in pair
            for k in pair
            if k != kept
        )
        for kept in (other, one)
    ]
    return BestPair(two=(tried[one], tried[other]), behind=tuple(behind))


def of_other_kind(
    axes: RecordAxes, chosen: Hypothesis, places: Iterable[EffectAt]
) -> list[Hypothesis]:
    """Return other effects than ``chosen`` at these places that show at its wavenumbers."""
    found: dict[EffectAt, Hypothesis] = {}
    for place in places:
        effect = BY_NAME[place.effect]
        if effect is chosen.effect or not effect.order_locked:
            continue
        for choice in variants(effect):
            h = hypothesis(effect, place.location, choice, line=axes.declaration)
            if same_wavenumbers(axes, chosen, h):
                found.setdefault(place, h)
    return list(found.values())


def same_wavenumbers(axes: RecordAxes, chosen: Hypothesis, h: Hypothesis) -> bool:
    """Return whether ``h`` is another effect or place with the same spectral lines of travel.

    A line in travel is told by the radius of its roller, not by what is wrong with that.
    """
    if h.key == chosen.key or "all" in (h.location, chosen.location):
        return False
    if not all(
        x.effect.order_locked and len(x.names) == DEGENERACY.paired_numbers for x in (chosen, h)
    ):
        return False
    ours, theirs = (np.array(wavenumbers_1_m(x, axes)) for x in (chosen, h))
    return ours.shape == theirs.shape and bool(
        np.all(abs(theirs / ours - 1.0) < DEGENERACY.same_coordinate_share)
    )


def pairs_by_score(
    objective: Objective, fit: Fit, hypotheses: Sequence[Hypothesis]
) -> list[tuple[float, tuple[int, int]]]:
    """Return the score of every two of ``hypotheses`` and their indices, best first.

    By one linear step from ``fit``, the price of their numbers taken off; of each two the one
    that explains more alone is first. What the line does not run with is left out.
    """
    columns = sensitivities(objective, fit, hypotheses)
    runs = [k for k, c in enumerate(columns) if np.isfinite(c).all()]
    if len(runs) < 2:
        return []
    columns = [columns[k] for k in runs]
    residual = objective.residual(objective.pool.one(fit.case), fit.shifts)
    inner = objective.projector.inner(residual, np.concatenate(columns, axis=1))
    ends = np.cumsum([0, *(c.shape[1] for c in columns)])
    own = [list(range(ends[k], ends[k + 1])) for k in range(len(columns))]
    alone = [inner.of(use).fit().chi2_reduction for use in own]
    rows = []
    for i, k in itertools.combinations(range(len(columns)), 2):
        use = own[i] + own[k]
        score = inner.of(use).fit().chi2_reduction - bic_penalty(objective, len(use))
        first, second = (i, k) if alone[i] >= alone[k] else (k, i)
        rows.append((score, (runs[first], runs[second])))
    return sorted(rows, reverse=True)
