"""The age of a named profile: by how much the roll's radius has fallen since it was formed, m.

On a larger roll its corners stand closer together.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from sim_plant.base.profiles import Profiles
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit, case_of, gauss_newton_fit, jacobian
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.fit.roll_synchronisation import synchronising_shifts
from sim_plant.refine.fit.spread import SPREAD
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search.completeness import sure_excess

PROFILE = CRITERIA.search.profile


def with_formation_radius(objective: Objective, fit: Fit, at: int) -> Fit:
    """Return the fit with the profile formed at another radius, where a record shows that.

    Only a strong one does. Declared numbers that change the length of a turn may have
    imitated it down to the noise: they start as declared.
    """
    profiles = fit.hypotheses[at].effect.profiles
    if profiles is None or profiles.age in fit.hypotheses[at].names:
        return fit
    if chi2_without_effects(objective, fit) < PROFILE.strong:
        return fit
    aged = []
    starts = formation_starts(objective, fit, at, profiles)
    for start in starts if any(may_show_age(objective, s, at) for s in starts) else []:
        shifts = synchronising_shifts(objective, {}, start.hypotheses, start.values)
        aged.append(
            gauss_newton_fit(
                objective,
                start.hypotheses,
                start.values,
                shifts,
                rounds=PROFILE.age_rounds,
                quick=False,
            )
        )
    best = likeliest_age(fit, aged, sure_excess(objective))
    return best if best is fit or knows(best, at, profiles.age) else fit


def may_show_age(objective: Objective, start: Fit, at: int) -> bool:
    """Return whether a fit can come to know the age of profile ``at``, by slopes at ``start``.

    A profile without corners, an ellipse, hardly shows it: then no fit is made.
    """
    profiles = start.hypotheses[at].effect.profiles
    columns = jacobian(objective, start.hypotheses, start.values, start.shifts)
    if profiles is None or not np.isfinite(columns).all():
        return True
    nothing = np.zeros(columns.shape[0])  # the covariance does not depend on the residual
    covariance = objective.projector.linear_fit(nothing, columns).covariance
    seen = replace(start, covariance=covariance)
    return knows(seen, at, profiles.age, room=PROFILE.age_room)


def knows(fit: Fit, at: int, name: str, room: float = 1.0) -> bool:
    """Return whether a fit knows a number of effect ``at`` better than its bounds do.

    Its interval is narrower than ``room`` times the distance of its bounds.
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
    """Return the best of ``aged`` unless ``fit``, with age 0, costs less by ``sure_excess``.

    Age 0 is no better known than any other, so another one need not pay the price of a number: it
    is kept with its interval, and found anew on the record on which the effects are judged.
    """
    best = min(aged, key=lambda there: there.cost, default=fit)
    return best if best.cost < fit.cost + sure_excess else fit


def chi2_without_effects(objective: Objective, fit: Fit) -> float:
    """Return by how much the cost is higher without any effect."""
    bare = objective.pool.one(case_of((), (), fit.shifts))
    return objective.projector.cost(objective.residual(bare, fit.shifts)) - fit.cost


def with_numbers(
    objective: Objective,
    fit: Fit,
    at: int,
    names: tuple[str, ...],
    start: Mapping[str, float] | None = None,
) -> Fit:
    """Return the fit with further numbers of effect ``at``, at ``start`` or absent, not fitted."""
    old = fit.hypotheses[at]
    line = objective.pool.twins[0].declaration
    more = tuple(name for name in names if name not in old.names)
    new = hypothesis(old.effect, old.location, old.fixed, (*old.names, *more), line)
    new = replace(new, record_index=old.record_index)
    known = {**(start or {}), **dict(zip(old.names, fit.values[at], strict=True))}
    values = [known.get(n, a) for n, a in zip(new.names, new.absent, strict=True)]
    return fit.with_effect_at(at, new, values)
