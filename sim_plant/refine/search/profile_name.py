"""Which named profile an outline is: they look alike at one radius, and differ at another."""

from __future__ import annotations

from sim_plant.base.profiles import Profile
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit, gauss_newton_fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.fit.roll_synchronisation import synchronising_shifts
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search.candidate import bic_penalty
from sim_plant.refine.search.completeness import sure_excess
from sim_plant.refine.search.profile_age import chi2_without_effects, with_formation_radius

PROFILE = CRITERIA.search.profile


def nearest_names(objective: Objective, fit: Fit, at: int) -> list[Profile]:
    """Return per name the profile most like the whole outline of effect ``at``, best first."""
    h = fit.hypotheses[at]
    profiles = h.effect.profiles
    if profiles is None:
        return []
    line = objective.pool.twins[0].declaration
    radius_m = line.rollers[line.body(h.location)].radius_m
    numbers = dict(zip(h.names, fit.values[at], strict=True))
    whole = profiles.orders(radius_m, {**dict(h.fixed), **numbers}, len(h.effect.quadratures))
    return profiles.nearest(radius_m, whole)


def with_best_name(objective: Objective, fit: Fit, at: int) -> Fit:
    """Return the fit with the profile under the name that explains most, with its age.

    The cost has a minimum under each name: which one a first look found depends on where it began,
    and on effects that were not known then. Others are tried where the profile is strong and more
    is left than noise.
    """
    best = with_formation_radius(objective, fit, at)
    left = best.cost - objective.expected_cost
    if left < sure_excess(objective) or chi2_without_effects(objective, fit) < PROFILE.strong:
        return best
    for profile in nearest_names(objective, fit, at)[: PROFILE.most_names]:
        if set(profile.choice) <= set(fit.hypotheses[at].fixed):
            continue
        named = with_formation_radius(objective, _named(objective, fit, at, profile), at)
        numbers = len(named.hypotheses[at].names) - len(best.hypotheses[at].names)
        if named.cost + bic_penalty(objective, numbers) < best.cost:
            best = named
    return best


def _named(objective: Objective, fit: Fit, at: int, profile: Profile) -> Fit:
    """Return the fit with effect ``at`` as this profile alone, all else fitted again."""
    h = fit.hypotheses[at]
    line = objective.pool.twins[0].declaration
    named = hypothesis(h.effect, h.location, profile.choice, profile.names, line)
    start = dict(zip(profile.names, profile.start, strict=True))
    there = fit.with_effect_at(at, named, [start[name] for name in named.names])
    shifts = synchronising_shifts(objective, fit.shifts, there.hypotheses, there.values)
    return gauss_newton_fit(
        objective, there.hypotheses, there.values, shifts, rounds=CRITERIA.fit.rounds, quick=False
    )


def without_unpaid_orders(objective: Objective, fit: Fit, at: int) -> Fit:
    """Return the fit with the profile alone, where the orders beside it do not pay their price.

    They may be what a profile is itself (an ellipse is its second order): no record then shows
    how much is the profile's, and how much the order's.
    """
    old = fit.hypotheses[at]
    orders = {name for pair in old.effect.quadratures for name in (pair.cos, pair.sin)}
    if old.effect.profiles is None or orders.isdisjoint(old.names):
        return fit
    numbers = dict(zip(old.names, fit.values[at], strict=True))
    plain = tuple(name for name in old.names if name not in orders)
    start = tuple(numbers[name] for name in plain)
    own = Profile(choice=old.fixed, names=plain, start=start)
    best = fit
    for profile in (own, nearest_names(objective, fit, at)[0]):
        alone = _named(objective, fit, at, profile)
        fewer = len(old.names) - len(alone.hypotheses[at].names)
        price = bic_penalty(objective, fewer) if best is fit else 0.0
        best = alone if alone.cost < best.cost + price else best
    return best
