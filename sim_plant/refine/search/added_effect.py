"""One more effect beside those accepted: all numbers fitted again, and whether they are known."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit, gauss_newton_fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.model.nuisances import is_effective_radius
from sim_plant.refine.model.parameter_effects import within_tolerance


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
