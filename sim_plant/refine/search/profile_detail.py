"""Details of a named profile that is there: kept only when the record itself bears them out."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.base.effects import Effect
from sim_plant.base.profiles import Profiles
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit, case_of, gauss_newton_fit, jacobian
from sim_plant.refine.fit.objective import Objective, relinearised_at, with_free_shapes
from sim_plant.refine.fit.roll_synchronisation import synchronising_shifts
from sim_plant.refine.fit.spread import SPREAD
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search.candidate import bic_penalty
from sim_plant.refine.search.completeness import sure_excess

PROFILE = CRITERIA.search.profile


def joint_refit(objective: Objective, fit: Fit) -> tuple[Objective, Fit]:
    """Return the objective linearised at a better fit, and that fit.

    All effects, their profiles' details and the declared numbers are fitted together at the
    declared drive tick, with responses taken there. Shapes that are there stay free in their low
    orders for what is searched next: a further effect must explain more than a detail of them.
    """
    exact = gauss_newton_fit(
        objective, fit.hypotheses, fit.values, fit.shifts, rounds=4, quick=False
    )
    if not np.isfinite(exact.cost):
        return objective, fit
    keeps = _keeps_responses(objective, exact)
    near = relinearised_at(objective, exact.case, keep_nuisance_changes=keeps)
    exact = gauss_newton_fit(
        near, fit.hypotheses, exact.values, exact.shifts, rounds=3, quick=False
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
    """Return whether the responses to declared numbers stay as they are with these effects.

    So it is with weak effects that are locked to an order: what an effect and a shift within
    tolerance do only together is some percent of what either does alone.
    """
    locked = all(h.effect.order_locked for h in fit.hypotheses)
    return locked and chi2_without_effects(objective, fit) < PROFILE.weak


def chi2_without_effects(objective: Objective, fit: Fit) -> float:
    """Return by how much the cost is higher without any effect."""
    bare = objective.pool.one(case_of((), (), fit.shifts))
    return objective.projector.cost(objective.residual(bare, fit.shifts)) - fit.cost


def named_profiles(fit: Fit) -> list[int]:
    """Return which of the effects of a fit are named profiles."""
    return [
        k
        for k, h in enumerate(fit.hypotheses)
        if h.effect.profiles is not None and h.effect.profiles.size in h.names
    ]


def with_later_numbers(objective: Objective, fit: Fit) -> Fit:
    """Return the fit with those numbers of its effects free that the library sets, where they pay.

    A first look cannot tell them, and beside a weak effect no record does: they would take its
    size with them.
    """
    for at, h in enumerate(fit.hypotheses):
        for name in h.effect.fitted_later:
            known = dict(h.fixed)
            if name not in known or name in fit.hypotheses[at].names:
                continue
            wider = with_numbers(objective, fit, at, (name,), {name: float(known[name])})
            better = gauss_newton_fit(
                objective, wider.hypotheses, wider.values, fit.shifts, rounds=6, quick=False
            )
            pays = better.cost < fit.cost - bic_penalty(objective, 1)
            if pays and not better.hypotheses[at].at_bound(better.values[at]):
                fit = better
    return fit


def with_profile_details(objective: Objective, fit: Fit) -> Fit:
    """Return the fit with details of its named profiles: when they were formed, and low orders.

    Orders are kept when numbers from either half of the record explain the other half better
    than none, and when they pay their price: those that the search fits, then finer ones.
    """
    for at in named_profiles(fit):
        fit = without_unpaid_orders(objective, fit, at)
        fit = with_formation_radius(objective, fit, at)
        for some in stages_of_orders(fit.hypotheses[at].effect):
            fit = with_paying_numbers(objective, fit, at, some)
    return fit


def without_unpaid_orders(objective: Objective, fit: Fit, at: int) -> Fit:
    """Return the fit with the profile alone, where the orders beside it do not pay their price.

    They may stand for what a profile is itself (an ellipse is its second order): no record then
    tells how much is the profile's, how much the order's.
    """
    old = fit.hypotheses[at]
    orders = {name for pair in old.effect.quadratures for name in (pair.cos, pair.sin)}
    profiles = old.effect.profiles
    if profiles is None or orders.isdisjoint(old.names):
        return fit
    line = objective.pool.twins[0].declaration
    radius_m = line.rollers[line.body(old.location)].radius_m
    numbers = dict(zip(old.names, fit.values[at], strict=True))
    whole = profiles.orders(radius_m, {**dict(old.fixed), **numbers}, len(old.effect.quadratures))
    nearest = profiles.nearest(radius_m, whole)
    plain = [name for name in old.names if name not in orders]
    started = [
        (old.fixed, {name: numbers[name] for name in plain}),
        (nearest.choice, dict(zip(nearest.names, nearest.start, strict=True))),
    ]
    best = fit
    for choice, start in started:
        h = hypothesis(old.effect, old.location, choice, tuple(start), line)
        there = fit.with_effect_at(at, h, [start[name] for name in h.names])
        shifts = synchronising_shifts(objective, fit.shifts, there.hypotheses, there.values)
        alone = gauss_newton_fit(
            objective, there.hypotheses, there.values, shifts, rounds=6, quick=False
        )
        price = bic_penalty(objective, len(old.names) - len(h.names)) if best is fit else 0.0
        best = alone if alone.cost < best.cost + price else best
    return best


def stages_of_orders(effect: Effect) -> list[tuple[str, ...]]:
    """Return the numbers of the orders that the search fits, then of those up to twice as many.

    And so on, each order once, up to the last that the effect has.
    """
    pairs = effect.quadratures
    ends = [sum(1 for pair in pairs if pair.cos in effect.traced)]
    while 0 < ends[-1] < len(pairs):
        ends.append(min(2 * ends[-1], len(pairs)))
    return [
        tuple(name for pair in pairs[first:last] for name in (pair.cos, pair.sin))
        for first, last in zip([0, *ends[:-1]], ends, strict=True)
    ]


def with_formation_radius(objective: Objective, fit: Fit, at: int) -> Fit:
    """Return the fit with the profile formed at another radius, where the record says so.

    Only a strong profile tells: its corners stand closer together on a larger roll. Declared
    numbers that change the length of a turn may have imitated this down to the noise: they start
    anew.
    """
    profiles = fit.hypotheses[at].effect.profiles
    if profiles is None or profiles.age in fit.hypotheses[at].names:
        return fit
    if chi2_without_effects(objective, fit) < PROFILE.strong:
        return fit
    aged = []
    starts = formation_starts(objective, fit, at, profiles)
    for there in starts if any(may_show_age(objective, s, at) for s in starts) else []:
        shifts = synchronising_shifts(objective, {}, there.hypotheses, there.values)
        aged.append(
            gauss_newton_fit(
                objective, there.hypotheses, there.values, shifts, rounds=8, quick=False
            )
        )
    best = likeliest_age(fit, aged, sure_excess(objective))
    return best if best is fit or knows(best, at, profiles.age) else fit


def may_show_age(objective: Objective, start: Fit, at: int) -> bool:
    """Return whether the age of profile ``at`` can come out as known, by the slopes at ``start``.

    A profile without corners, an ellipse, hardly shows it: then no fit is made.
    """
    profiles = start.hypotheses[at].effect.profiles
    columns = jacobian(objective, start.hypotheses, start.values, start.shifts)
    if profiles is None or not np.isfinite(columns).all():
        return True
    nothing = np.zeros(columns.shape[0])  # what is left says nothing of how well it is known
    covariance = objective.projector.linear_fit(nothing, columns).covariance
    seen = replace(start, covariance=covariance)
    return knows(seen, at, profiles.age, room=PROFILE.age_room)


def knows(fit: Fit, at: int, name: str, room: float = 1.0) -> bool:
    """Return whether a fit knows a number of effect ``at`` better than that it is within bounds.

    Its interval is narrower than ``room`` times them.
    """
    h = fit.hypotheses[at]
    number = h.names.index(name)
    row = sum(len(v) for v in fit.values[:at]) + number
    variance = float(fit.covariance[row, row]) if fit.covariance.size else np.inf
    width = 2.0 * SPREAD * math.sqrt(max(variance, 0.0))
    return width < room * (h.high[number] - h.low[number])


def formation_starts(objective: Objective, fit: Fit, at: int, profiles: Profiles) -> list[Fit]:
    """Return the fit with profile ``at`` formed at other radii that this roll can have had."""
    wider = [
        with_numbers(objective, fit, at, (profiles.age,), {profiles.age: start})
        for start in profiles.age_tries
    ]
    return [there for there in wider if there.hypotheses[at].within(there.values[at])]


def likeliest_age(fit: Fit, aged: Sequence[Fit], sure_excess: float) -> Fit:
    """Return the best of ``aged`` unless ``fit`` is better by more than noise is known to.

    A profile's age is the length of web that was unwound since it was formed, 0 in ``fit``. That
    is no better known than any other age, so another one need not pay a price: it is kept with
    its interval, and fitted anew where the effects are judged.
    """
    best = min(aged, key=lambda there: there.cost, default=fit)
    return best if best.cost < fit.cost + sure_excess else fit


def with_paying_numbers(objective: Objective, fit: Fit, at: int, names: tuple[str, ...]) -> Fit:
    """Return the fit with more numbers of effect ``at`` where they predict halves, and pay."""
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
        objective, wider.hypotheses, wider.values, fit.shifts, rounds=4, quick=False
    )
    return better if better.cost < fit.cost - bic_penalty(objective, len(names)) else fit


def with_numbers(
    objective: Objective,
    fit: Fit,
    at: int,
    names: tuple[str, ...],
    start: Mapping[str, float] | None = None,
) -> Fit:
    """Return the fit with more numbers of effect ``at``, at ``start`` or absent, not fitted."""
    old = fit.hypotheses[at]
    line = objective.pool.twins[0].declaration
    more = tuple(name for name in names if name not in old.names)
    new = hypothesis(old.effect, old.location, old.fixed, (*old.names, *more), line)
    new = replace(new, record=old.record)
    known = {**(start or {}), **dict(zip(old.names, fit.values[at], strict=True))}
    values = [known.get(n, a) for n, a in zip(new.names, new.absent, strict=True)]
    return fit.with_effect_at(at, new, values)


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
    """Return which judged rows belong to the first half of their record, and to the second."""
    marks = []
    for part in objective.split(np.zeros(objective.rows)):
        mark = np.zeros(part.shape, dtype=bool)
        mark[:, : part.shape[1] // 2] = True
        marks.append(mark.ravel())
    first = np.concatenate(marks)
    return first, ~first
