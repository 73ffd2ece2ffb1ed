"""An effect whose size is not quite constant: its slow changes as terms.

Each term has one size in all channels: free, or random with a prior.
How well a roller holds the web varies from minute to minute. A model of constant size leaves some
of that in all channels where the effect itself shows, in the same proportions.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np

from sim_plant.effects.onset import HOLD_S
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.fit.objective import Objective, with_wander
from sim_plant.refine.fit.start_states import Changes
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.model.twin import Added, Twin

WANDERING = CRITERIA.search.wandering


def wander_changes(pool: SimulationPool, fit: Fit, at: int) -> list[Changes]:
    """Return what changes as the size of effect ``at`` wanders about its mean, one term each.

    On every record of the pool.

    The size is raised for one interval after another. A term is the answer to one of them less
    that to the one before, so that all terms together leave the mean size alone.
    """
    return [
        tuple(y - before for y, before in zip(later, first, strict=True))
        for changes in _answers(pool, fit, at)
        for first, later in pairwise(changes)
    ]


def weighed_with_wander(objective: Objective, fit: Fit) -> Objective:
    """Return the objective in which the sizes of a fit's effects may wander, each by its prior.

    Slope and threshold of a slip are known best just above the threshold, where there is least of
    it to wander; without this the record's plateau of the highest speed decides both. The
    covariance of a fit then includes that a slip's size at each plateau of the speed is off by
    more than noise alone gives.
    """
    wandering = [k for k, h in enumerate(fit.hypotheses) if h.effect.wander > 0.0]
    changes: list[Changes] = []
    deviations: list[float] = []
    for at in wandering:
        for answers in _answers(objective.pool, fit, at):
            changes += answers
            sd = math.sqrt(fit.hypotheses[at].effect.wander) / WANDERING.share
            deviations += [sd] * len(answers)
    return with_wander(objective, changes, deviations) if changes else objective


def _answers(pool: SimulationPool, fit: Fit, at: int) -> Iterator[list[Changes]]:
    """Yield per record that has effect ``at`` what its size, raised in one interval, changes."""
    case = fit.case
    for record, twin in enumerate(pool.twins):
        if fit.hypotheses[at].record_index not in (None, record):
            continue
        raised = raised_for_a_while(fit, at, record, _duration_s(twin))
        cases = [replace(case, effects=(*case.effects, one)) for one in raised]
        base, *runs = pool.run([case, *cases])
        yield [tuple(y - b for y, b in zip(run, base, strict=True)) for run in runs]


def raised_for_a_while(fit: Fit, at: int, record: int, duration_s: float) -> list[Added]:
    """Return effect ``at`` once per interval of a record, there alone, at a share of its size."""
    h, values = fit.hypotheses[at], fit.values[at]
    onset = h.effect.onset
    if onset is None:
        return []
    share = WANDERING.share
    sizes = [
        absent + share * (value - absent)
        for value, absent in zip(values[: h.strength_count], h.absent, strict=False)
    ]
    given = dict(h.added((*sizes, *values[h.strength_count :])).parameters)
    begins_s = max(0.0, float(given[onset.moment])) if h.moment_parameter else 0.0
    count = max(1, round((duration_s - begins_s) / WANDERING.interval_s))
    edges = np.linspace(begins_s, duration_s, count + 1)
    return [
        Added(
            h.effect.name,
            h.location,
            tuple({**given, onset.moment: float(first), HOLD_S: float(last - first)}.items()),
            record,
        )
        for first, last in pairwise(edges)
    ]


def _duration_s(twin: Twin) -> float:
    return float(twin.speed_m_s.size * twin.declaration.sample_time_s)
