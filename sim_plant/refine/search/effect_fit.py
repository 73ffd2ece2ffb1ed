"""One effect fitted with those accepted already, by its profiles where it has some."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit, case_of, gauss_newton_fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.fit.roll_synchronisation import synchronising_shifts
from sim_plant.refine.model.hypotheses import Hypothesis, hypothesis
from sim_plant.refine.model.nuisances import effective_radius_of, is_effective_radius
from sim_plant.refine.model.parameter_effects import within_tolerance
from sim_plant.refine.search.candidate import (
    Candidate,
    FittedCandidate,
    Progress,
    bic_penalty,
    fitted_candidate,
)


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
    excess = base.cost - objective.expected_cost
    least = CRITERIA.search.profile.orders_share * excess
    if best is None or base.cost - best.cost < least:
        free = with_effect(objective, base, *candidate.trimmed(), base.shifts, rounds=2)
        best = _best(objective, [best, free])
    return best


def rolling_only(shifts: dict[str, float]) -> dict[str, float]:
    """Return shifts of effective radii alone.

    Without the effect, other declared numbers have moved to imitate it; from there a fit would
    not find back.
    """
    return {name: value for name, value in shifts.items() if is_effective_radius(name)}


def with_effect(
    objective: Objective,
    base: Fit,
    h: Hypothesis,
    start: Sequence[float],
    shifts: dict[str, float],
    rounds: int = 6,
) -> Fit | None:
    """Return ``base`` with ``h`` from ``start``, all fitted again; None as ``fit_candidate``."""
    fit = gauss_newton_fit(
        objective, (*base.hypotheses, h), (*base.values, tuple(start)), shifts, rounds=rounds
    )
    found, line = fit.values[-1], objective.pool.twins[0].declaration
    if not np.isfinite(fit.cost) or h.at_bound(found) or not certain_size(fit):
        return None
    return None if within_tolerance(line, objective.nuisances, h, found) else fit


def certain_size(fit: Fit) -> bool:
    """Return whether the last effect's strengths, all else free, are known to be something.

    Equation: a' C^-1 a > chi-square of certain_size  [Wald]. A line whose frequency and size can
    be traded for drift fits well and says nothing of how large it is.
    """
    h, values = fit.hypotheses[-1], fit.values[-1]
    if h.curved or not fit.covariance.size:
        return True
    at = fit.covariance.shape[0] - len(values)
    inside = slice(at, at + h.strengths)
    size = np.subtract(values[: h.strengths], h.absent[: h.strengths])
    known = np.linalg.lstsq(fit.covariance[inside, inside], size, rcond=None)[0]
    return bool(size @ known > CRITERIA.search.acceptance.certain_size)


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
    """Return shifts without the effective radius of a roll: a profile brings its own mean."""
    return {name: value for name, value in shifts.items() if name != effective_radius_of(roll)}


def _profile_starts(
    objective: Objective, fit: Fit, h: Hypothesis
) -> list[tuple[Hypothesis, tuple[float, ...]]]:
    """Return the named profiles that explain most in addition to ``fit``, for ``h`` (free)."""
    profiles = h.effect.profiles
    if profiles is None:
        return []
    shifts = synchronising_shifts(objective, fit.shifts, fit.hypotheses, fit.values)
    case = case_of(fit.hypotheses, fit.values, shifts)
    runs = objective.pool.run(
        [case, *(replace(case, effects=(*case.effects, a)) for a in h.probes())]
    )
    columns = objective.columns(runs[1:], runs[0], np.ones(len(runs) - 1))
    inner = objective.projector.inner(objective.residual(runs[0], shifts), columns)
    line = objective.pool.twins[0].declaration
    radius = line.rollers[line.body(h.location)].radius_m
    found = profiles.starts(radius, inner.gram, inner.against, h.start)
    return [(hypothesis(h.effect, h.location, p.choice, p.names), p.start) for p in found]
