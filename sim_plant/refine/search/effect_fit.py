"""One effect fitted beside those that are there already, by its profiles where it has some."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.fit.gauss_newton import Fit, case_of, refine_fit
from sim_plant.refine.fit.objective import Problem
from sim_plant.refine.fit.roll_synchronisation import felt_radius, in_step
from sim_plant.refine.model.hypotheses import Hypothesis, hypothesis
from sim_plant.refine.model.parameter_effects import within_tolerance
from sim_plant.refine.search.screening import Scored, price


def fit_one(problem: Problem, fit: Fit, scored: Scored) -> Fit | None:
    """Return ``fit`` with one more effect, None where its numbers are no estimate."""
    h = scored.hypothesis
    if h.effect.profiles is None:
        return fitted(problem, fit, h, scored.start, fit.shifts)
    # a profile brings its own mean radius
    shifts = {name: value for name, value in fit.shifts.items() if name != felt_radius(h.location)}
    best: Fit | None = None
    for hyp, start in _profiles(problem, fit, h):
        there = (*fit.hypotheses, hyp), (*fit.values, start)
        new = fitted(problem, fit, hyp, start, in_step(problem, shifts, *there))
        if new is not None and (best is None or _worth(problem, new) < _worth(problem, best)):
            best = new
    excess = fit.cost - problem.expected_cost
    if best is None or fit.cost - best.cost < 0.9 * excess:
        free = fitted(problem, fit, *scored.trimmed(), fit.shifts, rounds=2)
        if free is not None and (best is None or _worth(problem, free) < _worth(problem, best)):
            best = free
    return best


def fitted(
    problem: Problem,
    fit: Fit,
    h: Hypothesis,
    start: Sequence[float],
    shifts: dict[str, float],
    rounds: int = 6,
) -> Fit | None:
    """Return ``fit`` with ``h`` from ``start``, all else fitted again; None as ``fit_one``."""
    new = refine_fit(
        problem, (*fit.hypotheses, h), (*fit.values, tuple(start)), shifts, rounds=rounds
    )
    h, found, line = new.hypotheses[-1], new.values[-1], problem.bench.twins[0].declaration
    if not np.isfinite(new.cost) or h.at_bound(found):
        return None
    return None if within_tolerance(line, problem.nuisances, h, found) else new


def reseated(problem: Problem, fit: Fit) -> Fit:
    """Return the fit with its profiles found anew beside all else, where that explains more.

    A second effect (a delay, a filter) changes how the line answers a shape: angles that were
    found without it are off by its phase, more than a step can mend.
    """
    line = problem.bench.twins[0].declaration
    for k, h in enumerate(fit.hypotheses):
        if h.effect.profiles is None:
            continue
        rest = replace(
            fit,
            hypotheses=(*fit.hypotheses[:k], *fit.hypotheses[k + 1 :]),
            values=(*fit.values[:k], *fit.values[k + 1 :]),
            shifts={n: v for n, v in fit.shifts.items() if n != felt_radius(h.location)},
        )
        for hyp, start in _profiles(problem, rest, hypothesis(h.effect, h.location, line=line)):
            there = fit.put(k, hyp, start)
            shifts = in_step(problem, rest.shifts, there.hypotheses, there.values)
            new = refine_fit(problem, there.hypotheses, there.values, shifts)
            if np.isfinite(new.cost) and new.cost < fit.cost:
                fit = new
    return fit


def _worth(problem: Problem, fit: Fit) -> float:
    return fit.cost + price(problem, len(fit.hypotheses[-1].names))


def _profiles(
    problem: Problem, fit: Fit, h: Hypothesis
) -> list[tuple[Hypothesis, tuple[float, ...]]]:
    profiles = h.effect.profiles
    if profiles is None:
        return []
    shifts = in_step(problem, fit.shifts, fit.hypotheses, fit.values)
    case = case_of(fit.hypotheses, fit.values, shifts)
    runs = problem.bench.run(
        [case, *(replace(case, effects=(*case.effects, a)) for a in h.probes())]
    )
    columns = np.stack([problem.column(r, runs[0], 1.0) for r in runs[1:]], axis=1)
    residual = problem.residual(runs[0], shifts)
    cut = problem.projector.project(columns)
    line = problem.bench.twins[0].declaration
    radius = line.rollers[line.body(h.location)].radius_m
    inner: Array = columns.T @ cut
    found = profiles.starts(radius, inner, cut.T @ residual, h.start)
    return [(hypothesis(h.effect, h.location, p.choice, p.names), p.start) for p in found]
