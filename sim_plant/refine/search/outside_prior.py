"""Declared numbers that a fit moves beyond tolerance, as effects to start a fit from.

A strong nuisance parameter is so well measured that one linear step cannot trade it for the effect
that changes it: the fit has to start at the shift that the nuisance already has.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit, is_tolerance
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.fit.spread import SPREAD, model_errors
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.model.parameter_effects import as_effects, declared_change
from sim_plant.refine.search.added_effect import rolling_only, with_effect
from sim_plant.refine.search.candidate import FittedCandidate, Progress, fitted_candidate

DEGENERACY = CRITERIA.search.degeneracy


@dataclass(frozen=True, slots=True, kw_only=True)
class PriorConflict:
    """Declared numbers that are, together, too far off to be tolerance.

    Attributes
    ----------
    number : path of the one furthest off.
    standard_deviations : its shift in prior standard deviations.
    chi2 : sum of the squares of all shifts in prior standard deviations.
    """

    number: str
    standard_deviations: float
    chi2: float


def total_shifts(objective: Objective, fit: Fit) -> dict[str, float]:
    """Return every nuisance shift of a fit, simulated and linear parts together."""
    run = objective.pool.one(fit.case)
    residual = objective.residual(run, fit.shifts, fit.case.quick)
    estimate = objective.projector.estimate(residual)[: len(objective.nuisances)]
    return {
        n.name: fit.shifts.get(n.name, 0.0) + float(e)
        for n, e in zip(objective.nuisances, estimate, strict=True)
    }


def fit_conflicts(
    objective: Objective, base: Fit, effects: Collection[str], progress: Progress
) -> list[FittedCandidate]:
    """Return fits with an effect in place of a declared number beyond tolerance.

    ``effects`` are the names in the library; no others are tried. Of each effect at a place the
    fit that costs least.
    """
    conflicts: dict[EffectAt, FittedCandidate] = {}
    for h, start, shifts in starts_outside_prior(objective, base, effects):
        if h.key in {k.key for k in base.hypotheses}:
            continue
        fit = with_effect(objective, base, h, start, shifts)
        if fit is None or (h.key in conflicts and conflicts[h.key].fit.cost <= fit.cost):
            continue
        candidate = fitted_candidate(objective, base, fit)
        progress(f"  {h.key}, beyond tolerance: score {candidate.score:.0f}")
        conflicts[h.key] = candidate
    return list(conflicts.values())


def starts_outside_prior(
    objective: Objective, fit: Fit, effects: Collection[str]
) -> list[tuple[Hypothesis, tuple[float, ...], dict[str, float]]]:
    """Return effects that change a declared number beyond tolerance, furthest off first.

    Each with the numbers it starts from and the shifts of all other declared numbers. Where the
    fit has moved the number, the effect starts there and the others stay as fitted. It is also
    tried with the others back as declared, but for effective radii: they may have moved because
    the effect was missing.
    """
    line = objective.pool.twins[0].declaration
    total = total_shifts(objective, fit)
    rows = zip(objective.nuisances, objective.prior_sd, strict=True)
    z = {n.name: total[n.name] / sd for n, sd in rows}
    starts: list[tuple[Hypothesis, tuple[float, ...], dict[str, float]]] = []

    def effects_of(name: str, shift: float) -> list[tuple[Hypothesis, tuple[float, ...]]]:
        return [p for p in as_effects(line, name, shift) if p[0].effect.name in effects]

    tried = 0
    for name in sorted(z, key=lambda k: -abs(z[k])):
        if abs(z[name]) < DEGENERACY.outside_prior_sd or tried >= DEGENERACY.most_outside:
            break
        others = {k: v for k, v in fit.shifts.items() if k != name}
        if name in fit.shifts:
            starts += [(*pair, others) for pair in effects_of(name, fit.shifts[name])]
        declared = effects_of(name, total[name])
        starts += [(*pair, rolling_only(others)) for pair in declared]
        tried += len(declared)
    return starts


def chi2_by_records(objective: Objective, fit: Fit, stand_ins: Collection[str] = ()) -> float:
    """Return the chi-square by which the records alone show the change that the last effect is.

    Of the declared numbers that it changes the tolerances do not count, nor those of ``stand_ins``
    that have moved in its place; those of all others do. 0 where the effect is no change of
    declared numbers.
    Equation: |P y|^2, y the response to the effect, P takes out all other declared numbers  [own].
    """
    h, values = fit.hypotheses[-1], fit.values[-1]
    line = objective.pool.twins[0].declaration
    numbers = declared_change(line, h, values)
    names = [n.name for n in objective.nuisances]
    if numbers.keys().isdisjoint(names):
        return 0.0
    own = [k for k, name in enumerate(names) if name in numbers or name in stand_ins]
    bare = replace(fit.case, effects=fit.case.effects[:-1])
    response = objective.column(objective.pool.one(fit.case), objective.pool.one(bare), 1.0)
    return objective.projector.cost_with_fixed(response, own)


def beyond_tolerance(objective: Objective, fit: Fit) -> bool:
    """Return whether the last effect is one declared number whose interval is outside tolerance.

    Each end of it: the tolerance of the number itself counts in the interval, and so does that
    the model is not exact (``model_errors``).
    Equation: (|x| - k s) |c| > tolerance, x the change, s its standard deviation, k of 95 %, c the
    change of the declared number per unit; where the effect changes several, of each  [own].
    """
    h, values = fit.hypotheses[-1], fit.values[-1]
    shift = declared_change(objective.pool.twins[0].declaration, h, values)
    if len(values) != 1 or not shift or not fit.covariance.size:
        return False
    change = abs(values[0] - h.absent[0])
    sd = math.hypot(math.sqrt(max(float(fit.covariance[-1, -1]), 0.0)), model_errors(fit)[-1])
    sure = max(0.0, change - SPREAD * sd) / max(change, 1e-300)
    known = {n.name: n.tolerance for n in objective.nuisances}
    return all(sure * abs(x) > known.get(number, 0.0) for number, x in shift.items())


def by_records(objective: Objective, candidate: FittedCandidate) -> FittedCandidate:
    """Return the candidate with what the records say of it where it is a declared number."""
    fit = candidate.fit
    return replace(
        candidate,
        chi2_by_records=chi2_by_records(objective, fit),
        beyond_tolerance=beyond_tolerance(objective, fit),
    )


def ending_conflict(
    objective: Objective, base: Fit, fitted: Sequence[FittedCandidate]
) -> list[FittedCandidate]:
    """Return the candidates, ``ends_conflict`` set where their fit ends that of ``base``.

    Nothing is looked at where no change of declared numbers may end it. Several others that stand
    in for one share its cost, and keep small what the records say of it while their tolerances
    count: of one that ends a conflict those of the numbers that stood in for it do not.
    """
    worth = [c for c in fitted if c.score > DEGENERACY.outside_prior_sd**2]
    if not any(c.chi2_by_records > 0.0 for c in worth) or joint_conflict(objective, base) is None:
        return list(fitted)
    return [_as_ending(objective, base, c) if c in worth else c for c in fitted]


def _as_ending(objective: Objective, base: Fit, candidate: FittedCandidate) -> FittedCandidate:
    """Return the candidate as one that ends the conflict of ``base``, if it does.

    What stood in for it are the numbers that ``base`` has ``stand_in_sd`` further off than the
    candidate's fit.
    """
    if joint_conflict(objective, candidate.fit) is not None:
        return candidate
    before, after = (total_shifts(objective, fit) for fit in (base, candidate.fit))
    rows = zip(objective.nuisances, objective.prior_sd, strict=True)
    least = DEGENERACY.stand_in_sd
    moved = {n.name for n, sd in rows if abs(before[n.name] - after[n.name]) > least * sd}
    shown = chi2_by_records(objective, candidate.fit, moved)
    return replace(candidate, ends_conflict=True, chi2_by_records=shown)


def joint_conflict(objective: Objective, fit: Fit) -> PriorConflict | None:
    """Return the conflict of declared numbers that are too far off to be tolerance, else None."""
    total = total_shifts(objective, fit)
    z = np.array([total[n.name] for n in objective.nuisances]) / objective.prior_sd
    if is_tolerance(z):
        return None
    at = int(np.argmax(np.abs(z)))
    return PriorConflict(
        number=objective.nuisances[at].name, standard_deviations=float(z[at]), chi2=float(z @ z)
    )
