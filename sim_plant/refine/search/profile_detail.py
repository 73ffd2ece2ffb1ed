"""Details of a named profile that is there: kept only when the record itself bears them out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.effects.out_of_round_roll import PAIRS
from sim_plant.refine.fit.gauss_newton import Fit, case_of, gauss_newton_fit, jacobian
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.fit.roll_synchronisation import synchronised_shifts
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.model.roll_profiles import EFFECT as OUT_OF_ROUND
from sim_plant.refine.model.roll_profiles import UNWOUND
from sim_plant.refine.search.completeness import cost_standard_deviation
from sim_plant.refine.search.screening import bic_penalty

ORDERS: tuple[str, ...] = tuple(name for pair in PAIRS for name in (pair.cos, pair.sin))
UNWOUND_STARTS_M = (0.006, 0.012, -0.006, -0.012)
STRONG = 1e5
"""Cost explained from which a profile is looked at for where it was formed."""
WEAK = 1e4
"""Cost explained up to which the second order of effects and tolerances is less than noise."""


def joint_refit(objective: Objective, fit: Fit) -> tuple[Objective, Fit]:
    """Return the problem put right at a better fit, and that fit.

    All effects, their profiles' details and the declared numbers are fitted together at the
    declared drive tick, with responses taken there. Shapes that are there stay free in their low
    orders for what is searched next: a further effect must explain more than a detail of them.
    """
    hypotheses = fit.hypotheses
    exact = gauss_newton_fit(objective, hypotheses, fit.values, fit.shifts, rounds=4, coarse=False)
    if not np.isfinite(exact.cost):
        return objective, fit
    weak = _weak(objective, exact)
    near = objective.relinearised_at(exact.case, weak=weak)
    exact = gauss_newton_fit(near, hypotheses, exact.values, exact.shifts, rounds=3, coarse=False)
    better = refined_profiles(near, exact)
    if better is not exact:
        near = near.relinearised_at(better.case, weak=weak)
    line = near.pool.twins[0].declaration
    bodies = [line.body(better.hypotheses[k].location) for k in shaped(better)]
    if bodies:
        near = near.with_free_shapes(bodies)
    rest = gauss_newton_fit(
        near, better.hypotheses, better.values, better.shifts, rounds=0, coarse=False
    )
    return near, replace(better, cost=rest.cost, residual=rest.residual)


def _weak(objective: Objective, fit: Fit) -> bool:
    """Return whether the effects leave the responses to declared numbers as they are.

    What an effect and a shift within tolerance do together is some percent of what either does.
    """
    locked = all(h.effect.order_locked for h in fit.hypotheses)
    return locked and _explained(objective, fit) < WEAK


def _explained(objective: Objective, fit: Fit) -> float:
    """Return by how much the cost is higher without any effect."""
    bare = objective.pool.one(case_of((), (), fit.shifts))
    return objective.projector.cost(objective.residual(bare, fit.shifts)) - fit.cost


def shaped(fit: Fit) -> list[int]:
    """Return which of the effects of a fit are named profiles."""
    return [
        k
        for k, h in enumerate(fit.hypotheses)
        if h.effect.name == OUT_OF_ROUND and "size_m" in h.names
    ]


def refined_profiles(objective: Objective, fit: Fit) -> Fit:
    """Return the fit with details of its named profiles: when they were formed, and low orders.

    Orders are kept when numbers from either half of the record explain the other half better
    than none, and when they pay their price.
    """
    for at in shaped(fit):
        fit = _formed(objective, fit, at)
        fit = _tried(objective, fit, at, ORDERS)
    return fit


def _formed(objective: Objective, fit: Fit, at: int) -> Fit:
    """Return the fit with the profile formed at another radius, where the record says so.

    A strong profile alone tells: its corners stand closer together on a larger roll. Declared
    numbers that have imitated this (they change the length of a turn) start anew; they may have
    done so down to the noise. That a profile is as old as its record is no better known than any
    other age, so it need not pay: one that is as good as noise is known to is kept, with its
    interval, and found anew where the effects are judged.
    """
    if UNWOUND in fit.hypotheses[at].names or _explained(objective, fit) < STRONG:
        return fit
    best, least = fit, fit.cost + cost_standard_deviation(objective)
    for start_m in UNWOUND_STARTS_M:
        wider = _wider(objective, fit, at, (UNWOUND,), {UNWOUND: start_m})
        if not wider.hypotheses[at].within(wider.values[at]):
            continue
        shifts = synchronised_shifts(objective, {}, wider.hypotheses, wider.values)
        new = gauss_newton_fit(
            objective, wider.hypotheses, wider.values, shifts, rounds=8, coarse=False
        )
        if new.cost < least:
            best, least = new, new.cost
    return best


def _tried(objective: Objective, fit: Fit, at: int, names: tuple[str, ...]) -> Fit:
    wider = _wider(objective, fit, at, names, {})
    if not improves_cross_validation(objective, wider, at, names):
        return fit
    better = gauss_newton_fit(
        objective, wider.hypotheses, wider.values, fit.shifts, rounds=4, coarse=False
    )
    return better if better.cost < fit.cost - bic_penalty(objective, len(names)) else fit


def _wider(
    objective: Objective, fit: Fit, at: int, names: tuple[str, ...], start: dict[str, float]
) -> Fit:
    """Return the fit with more numbers of effect ``at`` free, at ``start`` or absent."""
    old = fit.hypotheses[at]
    line = objective.pool.twins[0].declaration
    new = hypothesis(old.effect, old.location, old.fixed, (*old.names, *names), line)
    known = {**start, **dict(zip(old.names, fit.values[at], strict=True))}
    values = [known.get(n, a) for n, a in zip(new.names, new.absent, strict=True)]
    return fit.put(at, new, values)


def improves_cross_validation(
    objective: Objective, fit: Fit, at: int, names: Sequence[str]
) -> bool:
    """Return whether effect ``at`` with ``names`` free predicts better across halves than without.

    Its numbers are taken by one linear step from one half of the record and judged on the other,
    both ways round: a detail that fits the noise of one half makes the other worse.
    """
    columns = jacobian(objective, fit.hypotheses, fit.values, fit.shifts)
    if not np.isfinite(columns).all():
        return False  # a taut web cannot follow such a shape
    first = sum(len(v) for v in fit.values[:at])
    own = columns[:, first : first + len(fit.values[at])]
    cut = objective.projector.project(own)[: objective.rows]
    left = fit.residual[: objective.rows]
    plain = [k for k, name in enumerate(fit.hypotheses[at].names) if name not in names]
    halves = _halves(objective)
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


def _halves(objective: Objective) -> tuple[Array, Array]:
    marks = []
    for part in objective.split(np.zeros(objective.rows)):
        mark = np.zeros(part.shape, dtype=bool)
        mark[:, : part.shape[1] // 2] = True
        marks.append(mark.ravel())
    first = np.concatenate(marks)
    return first, ~first
