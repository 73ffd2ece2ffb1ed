"""One more effect beside those accepted: all numbers fitted again, and whether they are known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit, gauss_newton_fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.model.hypotheses import Hypothesis, hypothesis
from sim_plant.refine.model.nuisances import is_effective_radius
from sim_plant.refine.model.parameter_effects import within_tolerance
from sim_plant.refine.search.candidate import bic_penalty


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
    rounds: int = CRITERIA.fit.rounds,
) -> Fit | None:
    """Return ``base`` with ``h`` from ``start``, all numbers fitted again.

    None where the effect's numbers are no estimate: the line does not run with them, one is at a
    bound, no size is certain, or the effect is a declared number within its tolerance, or one that
    is another one before the record is judged.
    """
    fit = gauss_newton_fit(
        objective, (*base.hypotheses, h), (*base.values, tuple(start)), shifts, rounds=rounds
    )
    if h.curved and np.isfinite(fit.cost):
        fit = without_idle(objective, fit)
        h = fit.hypotheses[-1]
    values, line = fit.values[-1], objective.pool.twins[0].declaration
    if not np.isfinite(fit.cost) or h.at_bound(values) or not certain_size(fit):
        return None
    if h.is_number_off(values, _judged_from_s(objective, h)):
        return None
    return None if within_tolerance(line, objective.nuisances, h, values) else fit


def _judged_from_s(objective: Objective, h: Hypothesis) -> float:
    """Return from when on, s, the record that an effect acts in is judged."""
    record = h.record_index or 0
    step_s = objective.pool.twins[record].declaration.sample_time_s
    return objective.whitening.noise[record].first * step_s


def without_idle(objective: Objective, fit: Fit) -> Fit:
    """Return the fit without strengths of its last effect that the records do not show.

    Play in a shaft whose torque never turns leaves no trace: its number goes anywhere, to a bound
    as well, which is no reason against the shaft. A strength stays where its absence costs more
    than a number's price, and the last one always does.
    """
    h, values = fit.hypotheses[-1], fit.values[-1]
    line = objective.pool.twins[0].declaration
    for k, (name, absent) in enumerate(zip(h.names, h.absent, strict=True)):
        if h.strength_count < 2 or k >= h.strength_count:
            break
        kept = tuple(n for n in h.names if n != name)
        choice = (*h.fixed, (name, absent))
        fewer = replace(
            hypothesis(h.effect, h.location, choice, kept, line), record_index=h.record_index
        )
        rest = tuple(v for n, v in zip(h.names, values, strict=True) if n != name)
        without = gauss_newton_fit(
            objective,
            (*fit.hypotheses[:-1], fewer),
            (*fit.values[:-1], rest),
            fit.shifts,
            rounds=2,
        )
        if without.cost < fit.cost + bic_penalty(objective, 1):
            return without_idle(objective, without)
    return fit


def certain_size(fit: Fit) -> bool:
    """Return whether the last effect's strengths, all else free, surely differ from absence.

    Equation: a' C^-1 a > chi-square of certain_size  [Wald]. A spectral line whose frequency and
    size can be traded for drift fits well, and its size is not known.
    """
    h, values = fit.hypotheses[-1], fit.values[-1]
    if h.curved or not fit.covariance.size:
        return True
    at = fit.covariance.shape[0] - len(values)
    inside = slice(at, at + h.strength_count)
    size = np.subtract(values[: h.strength_count], h.absent[: h.strength_count])
    weighed = np.linalg.lstsq(fit.covariance[inside, inside], size, rcond=None)[0]
    return bool(size @ weighed > CRITERIA.search.acceptance.certain_size)
