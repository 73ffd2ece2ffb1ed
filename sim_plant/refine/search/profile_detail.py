"""Details of a named profile: its age and orders beside it, kept where the records show them.

Its age is by how much the radius has fallen since the profile was formed, m.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.base.effects import Effect
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit, gauss_newton_fit, jacobian
from sim_plant.refine.fit.objective import Objective, relinearised_at, with_free_shapes
from sim_plant.refine.search.candidate import bic_penalty
from sim_plant.refine.search.profile_age import chi2_without_effects, with_numbers
from sim_plant.refine.search.profile_name import with_best_name, without_unpaid_orders

FIT, PROFILE = CRITERIA.fit, CRITERIA.search.profile


def joint_refit(objective: Objective, fit: Fit) -> tuple[Objective, Fit]:
    """Return the objective linearised at a better fit, and that fit.

    All effects, their profiles' details and the declared numbers are fitted together at the
    declared drive tick. Responses to declared numbers and start states are taken anew around the
    fit, unless the old ones will do. For the search that follows, profiles found stay free in
    their low orders: a further effect must explain more than a detail of them.
    """
    exact = gauss_newton_fit(
        objective, fit.hypotheses, fit.values, fit.shifts, rounds=FIT.rounds_near, quick=False
    )
    if not np.isfinite(exact.cost):
        return objective, fit
    keeps = _keeps_responses(objective, exact)
    near = relinearised_at(objective, exact.case, keep_nuisance_changes=keeps)
    exact = gauss_newton_fit(
        near, fit.hypotheses, exact.values, exact.shifts, rounds=FIT.rounds_again, quick=False
    )
    better = with_later_numbers(near, with_profile_details(near, exact))
    if better is not exact:
        near = relinearised_at(near, better.case, keep_nuisance_changes=keeps)
    line = near.pool.twins[0].declaration
    bodies = [line.body(better.hypotheses[k].location) for k in named_profiles(better)]
    if bodies:
        near = with_free_shapes(near, bodies)
    rest = gauss_newton_fit(
        near, better.hypotheses, better.values, better.shifts, rounds=0, quick=False
    )
    return near, replace(better, cost=rest.cost, residual=rest.residual)


def _keeps_responses(objective: Objective, fit: Fit) -> bool:
    """Return whether the responses to declared numbers need not be taken anew with these effects.

    So it is with weak effects that are locked to an order: what an effect and a shift within
    tolerance do only together is some percent of what either does alone.
    """
    locked = all(h.effect.order_locked for h in fit.hypotheses)
    return locked and chi2_without_effects(objective, fit) < PROFILE.weak


def named_profiles(fit: Fit) -> list[int]:
    """Return the indices of the effects of a fit that are named profiles."""
    return [
        k
        for k, h in enumerate(fit.hypotheses)
        if h.effect.profiles is not None and h.effect.profiles.size in h.names
    ]


def with_later_numbers(objective: Objective, fit: Fit) -> Fit:
    """Return the fit with those numbers free that are ``fitted_later``, where they pay.

    Until then they are fixed: a first look does not show them, and of a weak effect no record
    does; a fit would trade them for its size.
    """
    for at, h in enumerate(fit.hypotheses):
        for name in h.effect.fitted_later:
            known = dict(h.fixed)
            if name not in known or name in fit.hypotheses[at].names:
                continue
            wider = with_numbers(objective, fit, at, (name,), {name: float(known[name])})
            better = gauss_newton_fit(
                objective,
                wider.hypotheses,
                wider.values,
                fit.shifts,
                rounds=FIT.rounds,
                quick=False,
            )
            pays = better.cost < fit.cost - bic_penalty(objective, 1)
            if pays and not better.hypotheses[at].at_bound(better.values[at]):
                fit = better
    return fit


def with_profile_details(objective: Objective, fit: Fit) -> Fit:
    """Return the fit with details of its named profiles: their name, age, and orders beside them.

    Orders are kept when sizes from either half of each record explain the other half better than
    none, and when they pay their price: first those that the search fits, then higher ones.
    """
    for at in named_profiles(fit):
        fit = without_unpaid_orders(objective, fit, at)
        fit = with_best_name(objective, fit, at)
        for some in stages_of_orders(fit.hypotheses[at].effect):
            fit = with_paying_numbers(objective, fit, at, some)
    return fit


def stages_of_orders(effect: Effect) -> list[tuple[str, ...]]:
    """Return the names of the orders that the search fits, then of those up to twice as many.

    And so on, each order once, up to the last that the effect has; a cosine and a sine of each.
    """
    pairs = effect.quadratures
    ends = [sum(1 for pair in pairs if pair.cos in effect.fitted)]
    while 0 < ends[-1] < len(pairs):
        ends.append(min(2 * ends[-1], len(pairs)))
    return [
        tuple(name for pair in pairs[first:last] for name in (pair.cos, pair.sin))
        for first, last in zip([0, *ends[:-1]], ends, strict=True)
    ]


def with_paying_numbers(objective: Objective, fit: Fit, at: int, names: tuple[str, ...]) -> Fit:
    """Return the fit with more numbers of effect ``at``, if they pay and predict across halves."""
    wider = with_numbers(objective, fit, at, names)
    columns = jacobian(objective, wider.hypotheses, wider.values, wider.shifts)
    if not np.isfinite(columns).all():
        return fit  # a taut web cannot follow such a shape
    first = sum(len(v) for v in wider.values[:at])
    own = objective.projector.project(columns[:, first : first + len(wider.values[at])])
    rows = objective.rows
    plain = [k for k, name in enumerate(wider.hypotheses[at].names) if name not in names]
    halves = halves_of(objective)
    if not improves_cross_validation(own[:rows], wider.residual[:rows], plain, halves):
        return fit
    better = gauss_newton_fit(
        objective, wider.hypotheses, wider.values, fit.shifts, rounds=FIT.rounds_near, quick=False
    )
    return better if better.cost < fit.cost - bic_penalty(objective, len(names)) else fit


def improves_cross_validation(
    columns: Array, residual: Array, plain: Sequence[int], halves: tuple[Array, Array]
) -> bool:
    """Return whether all ``columns`` predict better across halves than the ``plain`` ones alone.

    Sizes are taken by one linear step from one half of the rows and judged on the other, both
    ways round: a detail that fits the noise of one half makes the other worse.
    """
    alone, wider = (
        sum(
            _prediction_error(columns[:, use], residual, one, other)
            for one, other in (halves, halves[::-1])
        )
        for use in (list(plain), list(range(columns.shape[1])))
    )
    return wider < alone


def _prediction_error(columns: Array, residual: Array, one: Array, other: Array) -> float:
    """Return the squared error on ``other`` rows with sizes taken from rows ``one``."""
    sizes = np.linalg.lstsq(columns[one], residual[one], rcond=None)[0]
    rest = residual[other] - columns[other] @ sizes
    return float(rest @ rest)


def halves_of(objective: Objective) -> tuple[Array, Array]:
    """Return masks (rows,) of the first halves of all records, and of the second."""
    marks = []
    for part in objective.split(np.zeros(objective.rows)):
        mark = np.zeros(part.shape, dtype=bool)
        mark[:, : part.shape[1] // 2] = True
        marks.append(mark.ravel())
    first = np.concatenate(marks)
    return first, ~first
