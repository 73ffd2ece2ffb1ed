"""One effect fitted with those accepted already; a named profile where it has such."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.base.profiles import Profile
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit, case_of, gauss_newton_fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.fit.roll_synchronisation import synchronising_shifts
from sim_plant.refine.model.hypotheses import Hypothesis, hypothesis
from sim_plant.refine.model.nuisances import effective_radius_of
from sim_plant.refine.search.added_effect import rolling_only, with_effect
from sim_plant.refine.search.candidate import (
    Candidate,
    FittedCandidate,
    Progress,
    bic_penalty,
    fitted_candidate,
)
from sim_plant.refine.search.completeness import sure_excess
from sim_plant.refine.search.profile_age import with_numbers
from sim_plant.refine.search.profile_detail import stages_of_orders

PROFILE = CRITERIA.search.profile


def fit_candidates(
    objective: Objective, base: Fit, candidates: Sequence[Candidate], progress: Progress
) -> list[FittedCandidate]:
    """Return ``base`` with each candidate fitted in addition, unless it is no estimate."""
    found = []
    for candidate in candidates:
        fit = fit_candidate(objective, base, candidate)
        if fit is not None:
            fitted = fitted_candidate(objective, base, fit)
            progress(f"  {fitted.hypothesis.key}: score {fitted.score:.0f}")
            found.append(fitted)
    return found


def fit_candidate(objective: Objective, base: Fit, candidate: Candidate) -> Fit | None:
    """Return ``base`` with one more effect, None where its numbers are no estimate."""
    h = candidate.hypothesis
    if h.effect.profiles is None:
        shifts = base.shifts if h.effect.order_locked else rolling_only(base.shifts)
        return with_effect(objective, base, h, candidate.start, shifts)
    shifts = _without_radius(base.shifts, h.location)
    fits = []
    for profile, start in _profile_starts(objective, base, h):
        there = (*base.hypotheses, profile), (*base.values, start)
        synchronising = synchronising_shifts(objective, shifts, *there)
        fits.append(with_effect(objective, base, profile, start, synchronising))
    best = _best(objective, fits)
    if best is not None and best.cost - objective.expected_cost < sure_excess(objective):
        return best
    free = with_free_orders(objective, base, candidate)
    return best if free is None else _best(objective, [best, as_profile(objective, free, best)])


def with_free_orders(objective: Objective, base: Fit, candidate: Candidate) -> Fit | None:
    """Return ``base`` with the candidate's orders, and finer ones as long as they pay.

    First those that paid at the first look. A roll may have any outline; one that is no named
    profile is described by its orders.
    """
    first, start = candidate.trimmed()
    profiles = first.effect.profiles
    if profiles is not None:
        line = objective.pool.twins[0].declaration
        place, choice = first.location, profiles.orders_choice
        first = hypothesis(first.effect, place, choice, first.names, line)
    fit = with_effect(objective, base, first, start, base.shifts)
    if fit is None:
        return None
    at = len(fit.hypotheses) - 1
    for some in stages_of_orders(fit.hypotheses[at].effect):
        if fit.cost - objective.expected_cost < sure_excess(objective):
            break
        wider = with_numbers(objective, fit, at, some)
        numbers = len(wider.hypotheses[at].names) - len(fit.hypotheses[at].names)
        if not numbers:
            continue
        more = gauss_newton_fit(objective, wider.hypotheses, wider.values, fit.shifts)
        if not more.cost < fit.cost - bic_penalty(objective, numbers):
            break
        fit = more
    return None if fit.hypotheses[at].at_bound(fit.values[at]) else fit


def as_profile(objective: Objective, free: Fit, named: Fit | None) -> Fit:
    """Return a fit of free orders as a named profile, with what that lacks as further orders.

    A profile determines its orders on a roll of another radius, a mix of orders does not. Tried
    are the most similar profile of each of the nearest names, and that of the fit ``named``.
    ``free`` itself is returned where none is as good.
    """
    h = free.hypotheses[-1]
    profiles, sizes = h.effect.profiles, dict(zip(h.names, free.values[-1], strict=True))
    used = [k for k, pair in enumerate(h.effect.quadratures) if pair.cos in sizes]
    if profiles is None or not used:
        return free
    pairs = h.effect.quadratures[: used[-1] + 1]
    orders = np.array([[sizes.get(p.cos, 0.0), sizes.get(p.sin, 0.0)] for p in pairs])
    line = objective.pool.twins[0].declaration
    radius_m = line.rollers[line.body(h.location)].radius_m
    tried = profiles.nearest(radius_m, orders)[: PROFILE.most_names]
    if named is not None and profiles.size in named.hypotheses[-1].names:
        own = named.hypotheses[-1]
        tried.append(Profile(choice=own.fixed, names=own.names, start=named.values[-1]))
    fits = [_with_details(objective, free, profile, orders) for profile in tried]
    most = free.cost + sure_excess(objective)
    good = [fit for fit in fits if fit.cost < most and not _at_bound(fit)]
    return min(good, key=lambda fit: fit.cost, default=free)


def _with_details(objective: Objective, free: Fit, profile: Profile, orders: Array) -> Fit:
    """Return the fit with this profile and orders beside it, from ``orders`` (n, 2), m, in all."""
    at = len(free.hypotheses) - 1
    h = free.hypotheses[at]
    line = objective.pool.twins[0].declaration
    profiles = h.effect.profiles
    start = dict(zip(profile.names, profile.start, strict=True))
    if profiles is not None:
        radius_m = line.rollers[line.body(h.location)].radius_m
        orders = orders - profiles.orders(radius_m, {**dict(profile.choice), **start}, len(orders))
    for pair, row in zip(h.effect.quadratures, orders, strict=False):
        start |= {pair.cos: float(row[0]), pair.sin: float(row[1])}
    named = hypothesis(h.effect, h.location, profile.choice, tuple(start), line)
    there = free.with_effect_at(at, named, [start[name] for name in named.names])
    shifts = _without_radius(free.shifts, h.location)
    shifts = synchronising_shifts(objective, shifts, there.hypotheses, there.values)
    return gauss_newton_fit(objective, there.hypotheses, there.values, shifts)


def _at_bound(fit: Fit) -> bool:
    return fit.hypotheses[-1].at_bound(fit.values[-1])


def profile_reinitialised(objective: Objective, fit: Fit) -> Fit:
    """Return the fit with its profiles found anew with all else, where that explains more.

    A second effect (a delay, a filter) changes how the line answers a shape: angles that were
    found without it are off by its phase, more than a step can mend.
    """
    line = objective.pool.twins[0].declaration
    for k, h in enumerate(fit.hypotheses):
        if h.effect.profiles is None:
            continue
        rest = replace(
            fit,
            hypotheses=(*fit.hypotheses[:k], *fit.hypotheses[k + 1 :]),
            values=(*fit.values[:k], *fit.values[k + 1 :]),
            shifts=_without_radius(fit.shifts, h.location),
        )
        orders = hypothesis(h.effect, h.location, line=line)
        for profile, start in _profile_starts(objective, rest, orders):
            there = fit.with_effect_at(k, profile, start)
            shifts = synchronising_shifts(objective, rest.shifts, there.hypotheses, there.values)
            new = gauss_newton_fit(objective, there.hypotheses, there.values, shifts)
            if np.isfinite(new.cost) and new.cost < fit.cost:
                fit = new
    return fit


def _best(objective: Objective, fits: Sequence[Fit | None]) -> Fit | None:
    """Return the fit that costs least, the price of its last effect's numbers included."""

    def penalised(fit: Fit) -> float:
        return fit.cost + bic_penalty(objective, len(fit.hypotheses[-1].names))

    return min((fit for fit in fits if fit is not None), key=penalised, default=None)


def _without_radius(shifts: dict[str, float], roll: str) -> dict[str, float]:
    """Return shifts without the effective radius of a roll: a profile has a mean of its own."""
    return {name: value for name, value in shifts.items() if name != effective_radius_of(roll)}


def _profile_starts(
    objective: Objective, fit: Fit, h: Hypothesis
) -> list[tuple[Hypothesis, tuple[float, ...]]]:
    """Return the named profiles that explain most beside ``fit``; ``h`` is their free orders."""
    profiles = h.effect.profiles
    if profiles is None:
        return []
    shifts = synchronising_shifts(objective, fit.shifts, fit.hypotheses, fit.values)
    case = case_of(fit.hypotheses, fit.values, shifts)
    runs = objective.pool.run(
        [case, *(replace(case, effects=(*case.effects, a)) for a in h.start_effects())]
    )
    columns = objective.columns(runs[1:], runs[0], np.ones(len(runs) - 1))
    inner = objective.projector.inner(objective.residual(runs[0], shifts), columns)
    line = objective.pool.twins[0].declaration
    radius = line.rollers[line.body(h.location)].radius_m
    starts = profiles.starts(radius, inner.gram, inner.against, h.start)
    return [(hypothesis(h.effect, h.location, p.choice, p.names), p.start) for p in starts]
