"""One effect fitted beside those that are there already, an out-of-round roll by its profiles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.fit.gauss_newton import Fit, case_of, gauss_newton_fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.fit.roll_synchronisation import effective_radius_of, synchronised_shifts
from sim_plant.refine.model.hypotheses import Hypothesis, hypothesis
from sim_plant.refine.model.parameter_effects import within_tolerance
from sim_plant.refine.model.roll_profiles import EFFECT as OUT_OF_ROUND
from sim_plant.refine.model.roll_profiles import profile_starts
from sim_plant.refine.search.screening import Candidate, bic_penalty


def fit_candidate(objective: Objective, fit: Fit, candidate: Candidate) -> Fit | None:
    """Return ``fit`` with one more effect, None where its numbers are no estimate."""
    h = candidate.hypothesis
    if h.effect.name != OUT_OF_ROUND:
        return with_effect(objective, fit, h, candidate.start, fit.shifts)
    # a profile brings its own mean radius
    shifts = {
        name: value
        for name, value in fit.shifts.items()
        if name != effective_radius_of(h.location)
    }
    best: Fit | None = None
    for hyp, start in _profiles(objective, fit, h):
        there = (*fit.hypotheses, hyp), (*fit.values, start)
        new = with_effect(
            objective, fit, hyp, start, synchronised_shifts(objective, shifts, *there)
        )
        if new is not None and (best is None or _worth(objective, new) < _worth(objective, best)):
            best = new
    excess = fit.cost - objective.expected_cost
    if best is None or fit.cost - best.cost < 0.9 * excess:
        free = with_effect(objective, fit, *candidate.trimmed(), fit.shifts, rounds=2)
        if free is not None and (
            best is None or _worth(objective, free) < _worth(objective, best)
        ):
            best = free
    return best


def with_effect(
    objective: Objective,
    fit: Fit,
    h: Hypothesis,
    start: Sequence[float],
    shifts: dict[str, float],
    rounds: int = 6,
) -> Fit | None:
    """Return ``fit`` with ``h`` from ``start``, all else fitted again; None as ``fit_one``."""
    new = gauss_newton_fit(
        objective, (*fit.hypotheses, h), (*fit.values, tuple(start)), shifts, rounds=rounds
    )
    h, found, line = new.hypotheses[-1], new.values[-1], objective.pool.twins[0].declaration
    if not np.isfinite(new.cost) or h.at_bound(found):
        return None
    return None if within_tolerance(line, objective.nuisances, h, found) else new


def profile_reinitialised(objective: Objective, fit: Fit) -> Fit:
    """Return the fit with its profiles found anew beside all else, where that explains more.

    A second effect (a delay, a filter) changes how the line answers a shape: angles that were
    found without it are off by its phase, more than a step can mend.
    """
    line = objective.pool.twins[0].declaration
    for k, h in enumerate(fit.hypotheses):
        if h.effect.name != OUT_OF_ROUND:
            continue
        rest = replace(
            fit,
            hypotheses=(*fit.hypotheses[:k], *fit.hypotheses[k + 1 :]),
            values=(*fit.values[:k], *fit.values[k + 1 :]),
            shifts={n: v for n, v in fit.shifts.items() if n != effective_radius_of(h.location)},
        )
        for hyp, start in _profiles(objective, rest, hypothesis(h.effect, h.location, line=line)):
            there = fit.put(k, hyp, start)
            shifts = synchronised_shifts(objective, rest.shifts, there.hypotheses, there.values)
            new = gauss_newton_fit(objective, there.hypotheses, there.values, shifts)
            if np.isfinite(new.cost) and new.cost < fit.cost:
                fit = new
    return fit


def _worth(objective: Objective, fit: Fit) -> float:
    return fit.cost + bic_penalty(objective, len(fit.hypotheses[-1].names))


def _profiles(
    objective: Objective, fit: Fit, h: Hypothesis
) -> list[tuple[Hypothesis, tuple[float, ...]]]:
    shifts = synchronised_shifts(objective, fit.shifts, fit.hypotheses, fit.values)
    case = case_of(fit.hypotheses, fit.values, shifts)
    runs = objective.pool.run(
        [case, *(replace(case, effects=(*case.effects, a)) for a in h.probes())]
    )
    columns = np.stack([objective.column(r, runs[0], 1.0) for r in runs[1:]], axis=1)
    residual = objective.residual(runs[0], shifts)
    cut = objective.projector.project(columns)
    line = objective.pool.twins[0].declaration
    radius = line.rollers[line.body(h.location)].radius_m
    inner: Array = columns.T @ cut
    return profile_starts(h.location, radius, inner, cut.T @ residual, h.start)
