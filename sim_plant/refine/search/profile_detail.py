"""Details of a named profile that is there: kept only when the record itself bears them out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.fit.gauss_newton import Fit, case_of, jacobian, refine_fit
from sim_plant.refine.fit.objective import Problem
from sim_plant.refine.fit.roll_synchronisation import in_step
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search.completeness import unsure
from sim_plant.refine.search.screening import price

STRONG = 1e5
"""Cost explained from which a profile is looked at for where it was formed."""
WEAK = 1e4
"""Cost explained up to which the second order of effects and tolerances is less than noise."""


def polished(problem: Problem, fit: Fit) -> tuple[Problem, Fit]:
    """Return the problem put right at a better fit, and that fit.

    All effects, their profiles' details and the declared numbers are fitted together at the
    declared drive tick, with responses taken there. Shapes that are there stay free in their low
    orders for what is searched next: a further effect must explain more than a detail of them.
    """
    hypotheses = fit.hypotheses
    exact = refine_fit(problem, hypotheses, fit.values, fit.shifts, rounds=4, coarse=False)
    if not np.isfinite(exact.cost):
        return problem, fit
    weak = _weak(problem, exact)
    near = problem.anchored(exact.case, weak=weak)
    exact = refine_fit(near, hypotheses, exact.values, exact.shifts, rounds=3, coarse=False)
    better = refined_profiles(near, exact)
    if better is not exact:
        near = near.anchored(better.case, weak=weak)
    line = near.bench.twins[0].declaration
    bodies = [line.body(better.hypotheses[k].location) for k in shaped(better)]
    if bodies:
        near = near.loosened(bodies)
    rest = refine_fit(
        near, better.hypotheses, better.values, better.shifts, rounds=0, coarse=False
    )
    return near, replace(better, cost=rest.cost, residual=rest.residual)


def _weak(problem: Problem, fit: Fit) -> bool:
    """Return whether the effects leave the responses to declared numbers as they are.

    What an effect and a shift within tolerance do together is some percent of what either does.
    """
    locked = all(h.effect.order_locked for h in fit.hypotheses)
    return locked and _explained(problem, fit) < WEAK


def _explained(problem: Problem, fit: Fit) -> float:
    """Return by how much the cost is higher without any effect."""
    bare = problem.bench.one(case_of((), (), fit.shifts))
    return problem.projector.cost(problem.residual(bare, fit.shifts)) - fit.cost


def shaped(fit: Fit) -> list[int]:
    """Return which of the effects of a fit are named profiles."""
    return [
        k
        for k, h in enumerate(fit.hypotheses)
        if h.effect.profiles is not None and h.effect.profiles.size in h.names
    ]


def refined_profiles(problem: Problem, fit: Fit) -> Fit:
    """Return the fit with details of its named profiles: when they were formed, and low orders.

    Orders are kept when numbers from either half of the record explain the other half better
    than none, and when they pay their price.
    """
    for at in shaped(fit):
        fit = _formed(problem, fit, at)
        pairs = fit.hypotheses[at].effect.quadratures
        fit = _tried(problem, fit, at, tuple(n for pair in pairs for n in (pair.cos, pair.sin)))
    return fit


def _formed(problem: Problem, fit: Fit, at: int) -> Fit:
    """Return the fit with the profile formed at another radius, where the record says so.

    A strong profile alone tells: its corners stand closer together on a larger roll. Declared
    numbers that have imitated this (they change the length of a turn) start anew; they may have
    done so down to the noise. That a profile is as old as its record is no better known than any
    other age, so it need not pay: one that is as good as noise is known to is kept, with its
    interval, and found anew where the effects are judged.
    """
    profiles = fit.hypotheses[at].effect.profiles
    if profiles is None or profiles.age in fit.hypotheses[at].names:
        return fit
    if _explained(problem, fit) < STRONG:
        return fit
    best, least = fit, fit.cost + unsure(problem)
    for start in profiles.age_tries:
        wider = _wider(problem, fit, at, (profiles.age,), {profiles.age: start})
        if not wider.hypotheses[at].within(wider.values[at]):
            continue
        shifts = in_step(problem, {}, wider.hypotheses, wider.values)
        new = refine_fit(problem, wider.hypotheses, wider.values, shifts, rounds=8, coarse=False)
        if new.cost < least:
            best, least = new, new.cost
    return best


def _tried(problem: Problem, fit: Fit, at: int, names: tuple[str, ...]) -> Fit:
    wider = _wider(problem, fit, at, names, {})
    if not bears_out(problem, wider, at, names):
        return fit
    better = refine_fit(
        problem, wider.hypotheses, wider.values, fit.shifts, rounds=4, coarse=False
    )
    return better if better.cost < fit.cost - price(problem, len(names)) else fit


def _wider(
    problem: Problem, fit: Fit, at: int, names: tuple[str, ...], start: dict[str, float]
) -> Fit:
    """Return the fit with more numbers of effect ``at`` free, at ``start`` or absent."""
    old = fit.hypotheses[at]
    line = problem.bench.twins[0].declaration
    new = hypothesis(old.effect, old.location, old.fixed, (*old.names, *names), line)
    known = {**start, **dict(zip(old.names, fit.values[at], strict=True))}
    values = [known.get(n, a) for n, a in zip(new.names, new.absent, strict=True)]
    return fit.put(at, new, values)


def bears_out(problem: Problem, fit: Fit, at: int, names: Sequence[str]) -> bool:
    """Return whether effect ``at`` with ``names`` free predicts better across halves than without.

    Its numbers are taken by one linear step from one half of the record and judged on the other,
    both ways round: a detail that fits the noise of one half makes the other worse.
    """
    columns = jacobian(problem, fit.hypotheses, fit.values, fit.shifts)
    if not np.isfinite(columns).all():
        return False  # a taut web cannot follow such a shape
    first = sum(len(v) for v in fit.values[:at])
    own = columns[:, first : first + len(fit.values[at])]
    cut = problem.projector.project(own)[: problem.rows]
    left = fit.residual[: problem.rows]
    plain = [k for k, name in enumerate(fit.hypotheses[at].names) if name not in names]
    halves = _halves(problem)
    found = [
        sum(_judged(cut[:, use], left, one, other) for one, other in (halves, halves[::-1]))
        for use in (plain, list(range(cut.shape[1])))
    ]
    return found[1] < found[0]


def _judged(columns: Array, left: Array, one: Array, other: Array) -> float:
    """Return the squared error on ``other`` rows with sizes taken from rows ``one``."""
    sizes = np.linalg.lstsq(columns[one], left[one], rcond=None)[0]
    rest = left[other] - columns[other] @ sizes
    return float(rest @ rest)


def _halves(problem: Problem) -> tuple[Array, Array]:
    marks = []
    for part in problem.split(np.zeros(problem.rows)):
        mark = np.zeros(part.shape, dtype=bool)
        mark[:, : part.shape[1] // 2] = True
        marks.append(mark.ravel())
    first = np.concatenate(marks)
    return first, ~first
