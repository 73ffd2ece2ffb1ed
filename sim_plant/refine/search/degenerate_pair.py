"""Whether the same effect at two other places says as much as the one at a place between them.

Rollers of one radius make one line of web travel; its phase and size along the web tell the place.
Two such rollers, both a little wrong, answer like a third one between them.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.search.screening import Candidate, bic_penalty, sensitivities
from sim_plant.refine.spectra.coordinates import Travel, wavenumbers_1_m

SAME_LINE = 0.003
MOST_PLACES = 4
NUMBERS = 2


def better_pair(
    objective: Objective, fit: Fit, travel: Travel, chosen: Hypothesis, ranked: Sequence[Candidate]
) -> tuple[tuple[str, str], ...]:
    """Return (effect, location) of two places that explain more than ``chosen``, or nothing.

    Both by one linear step, each number at its price; ``ranked`` are first looks at ``fit``.
    """
    alone = [s for s in ranked if s.hypothesis.key == chosen.key]
    others = [s for s in ranked if _same_line(travel, chosen, s.hypothesis)][:MOST_PLACES]
    if not alone or len(others) < 2:
        return ()
    columns = sensitivities(objective, fit, [s.hypothesis for s in others])
    residual = objective.residual(objective.pool.one(fit.case), fit.shifts)
    best, pair = max(
        (_score(objective, residual, np.concatenate([columns[i], columns[k]], axis=1)), (i, k))
        for i, k in itertools.combinations(range(len(others)), 2)
    )
    return tuple(others[k].hypothesis.key for k in pair) if best > alone[0].score else ()


def _same_line(travel: Travel, chosen: Hypothesis, h: Hypothesis) -> bool:
    """Return whether ``h`` is the effect at another place with the same line of travel."""
    if h.effect.name != chosen.effect.name or h.location == chosen.location:
        return False
    if (
        not h.effect.order_locked
        or len(h.names) != NUMBERS
        or "all" in (h.location, chosen.location)
    ):
        return False
    ours, theirs = (np.array(wavenumbers_1_m(x, travel)) for x in (chosen, h))
    return ours.shape == theirs.shape and bool(np.all(abs(theirs / ours - 1.0) < SAME_LINE))


def _score(objective: Objective, residual: Array, columns: Array) -> float:
    return objective.projector.gain(residual, columns).chi2_reduction - bic_penalty(
        objective, columns.shape[1]
    )
