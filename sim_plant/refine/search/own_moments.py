"""What begins where an effect that was found begins to act may be what that one's model has wrong.

A limit, a delay or a filter acts while a reference changes and rests between. What its model has
wrong of that is there at the same moments, where anything that may begin can imitate it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit, case_of
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.search.candidate import FittedCandidate, Progress
from sim_plant.refine.spectra.coordinates import is_periodic
from sim_plant.refine.spectra.moment_axis import moment_axis

EVENTS = CRITERIA.search.events
REMAINDER_SHARE = CRITERIA.search.unexplained.remainder_share


def more_than_model_errors(
    objective: Objective, base: Fit, fitted: Sequence[FittedCandidate], progress: Progress
) -> list[FittedCandidate]:
    """Return the candidates but for events that the model errors of ``base``'s effects can be.

    An event has to explain more than ``remainder_share`` of what those effects begin to do at its
    moment. Not counted are effects with spectral lines, whose errors lie there too, see
    ``set_apart``.
    """
    if not any(c.hypothesis.moment_parameter for c in fitted):
        return list(fitted)
    powers = response_powers(objective, base)
    kept: list[FittedCandidate] = []
    for c in fitted:
        least = REMAINDER_SHARE * _begun_power(objective, c, powers) if powers else 0.0
        if c.chi2_reduction > least:
            kept.append(c)
        else:
            progress(f"  {c.hypothesis.key}: others begin to act there, whose error it may be")
    return kept


def response_powers(objective: Objective, fit: Fit) -> list[Array]:
    """Return what effects without a spectral line do, as chi-square per judged sample.

    One row (samples,) per record; nothing where the fit has no such effect.
    """
    rest = [k for k, h in enumerate(fit.hypotheses) if is_periodic(h)]
    if len(rest) == len(fit.hypotheses):
        return []
    hypotheses, values = [fit.hypotheses[k] for k in rest], [fit.values[k] for k in rest]
    without = case_of(hypotheses, values, fit.shifts)
    with_all, with_rest = objective.pool.run([fit.case, without])
    change = [y - r for y, r in zip(with_all, with_rest, strict=True)]
    return [np.sum(part**2, axis=0) for part in objective.split(objective.whitened(change))]


def begun_power(power: Array, at: int, samples: int) -> float:
    """Return how much more of ``power`` (samples,) is in so many ``samples`` from ``at`` on.

    Than in as many before it; 0 where it is less.
    """
    before, after = power[max(0, at - samples) : at], power[at : at + samples]
    return max(0.0, float(after.sum()) - float(before.sum()))


def _begun_power(objective: Objective, c: FittedCandidate, powers: Sequence[Array]) -> float:
    """Return what effects begin to do at a candidate's moment; 0 of one that has none."""
    h, onset = c.hypothesis, c.hypothesis.effect.onset
    if not h.moment_parameter or onset is None:
        return 0.0
    moment = h.moment_of(c.fit.values[-1])
    record = h.record_index or 0
    twin = objective.pool.twins[record]
    axis = moment_axis(twin, objective.whitening.noise[record].first, onset.unit)
    at = int(np.searchsorted(axis.moments, moment))
    samples = round(EVENTS.known_apart_s / twin.declaration.sample_time_s)
    return begun_power(powers[record], at, samples)
