"""Whether the same effect at two other places explains as much as at one place between them.

Rollers of one radius make one spectral line in web travel; only its phase and size along the web
depend on the place. Two such rollers, both a little out of true, look like a third between them.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.model.hypotheses import Hypothesis
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
    columns = sensitivities(objective, fit, others)
    residual = objective.residual(objective.pool.one(fit.case), fit.shifts)
    best, pair = max(
        (pair_score(objective, residual, columns[i], columns[k]), (i, k))
        for i, k in itertools.combinations(range(len(others)), 2)
    )
    return tuple(others[k].key for k in pair) if best > alone[0].score else ()


def same_wavenumbers(axes: RecordAxes, chosen: Hypothesis, h: Hypothesis) -> bool:
    """Return whether ``h`` is the same effect elsewhere with the same spectral lines of travel."""
    if h.effect.name != chosen.effect.name or h.location == chosen.location:
        return False
    if (
        not h.effect.order_locked
        or len(h.names) != DEGENERACY.paired_numbers
        or "all" in (h.location, chosen.location)
    ):
        return False
    ours, theirs = (np.array(wavenumbers_1_m(x, axes)) for x in (chosen, h))
    return ours.shape == theirs.shape and bool(
        np.all(abs(theirs / ours - 1.0) < DEGENERACY.same_coordinate_share)
    )


def pair_score(objective: Objective, residual: Array, one: Array, other: Array) -> float:
    """Return the score of two places from their columns (rows, numbers), penalty taken off."""
    columns = np.concatenate([one, other], axis=1)
    joint = objective.projector.linear_fit(residual, columns)
    return joint.chi2_reduction - bic_penalty(objective, columns.shape[1])
