"""Declared numbers pulled beyond tolerance, as effects to start a fit from.

A strong nuisance is so well measured that one linear step cannot trade it for its effect: the
fit has to start where the nuisance already is.
"""

from __future__ import annotations

import numpy as np

from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.model.parameter_effects import as_effect

PULLED = 4.0
MOST = 3

Start = tuple[Hypothesis, tuple[float, ...], dict[str, float]]


def total_shifts(objective: Objective, fit: Fit) -> dict[str, float]:
    """Return every nuisance shift of a fit, simulated and linear parts together."""
    run = objective.pool.one(fit.case)
    estimate = objective.projector.estimate(objective.residual(run, fit.shifts, fit.case.coarse))
    return {
        n.name: fit.shifts.get(n.name, 0.0) + float(e)
        for n, e in zip(objective.nuisances, estimate[: objective.sd.size], strict=True)
    }


def starts_outside_prior(objective: Objective, fit: Fit, without: frozenset[str]) -> list[Start]:
    """Return effects that say the same as a declared number beyond tolerance, most pulled first.

    ``without`` names effects that are not in the library.
    """
    line = objective.pool.twins[0].declaration
    total = total_shifts(objective, fit)
    z = {
        n.name: total[n.name] / sd for n, sd in zip(objective.nuisances, objective.sd, strict=True)
    }
    found: list[Start] = []
    for name in sorted(z, key=lambda k: -abs(z[k])):
        if abs(z[name]) < PULLED or len(found) == MOST:
            break
        pair = as_effect(line, name, total[name])
        if pair is None or pair[0].effect.name in without:
            continue
        rest = {k: v for k, v in fit.shifts.items() if k != name}
        found.append((*pair, rest))
    return found


def joint_conflict(objective: Objective, fit: Fit) -> tuple[str, float, float] | None:
    """Return (number, its z, sum of z squared) when shifts are too many sd to be tolerance."""
    total = total_shifts(objective, fit)
    z = np.array([total[n.name] for n in objective.nuisances]) / objective.sd
    if float(z @ z) < z.size + 6.0 * np.sqrt(2.0 * z.size):
        return None
    at = int(np.argmax(np.abs(z)))
    return objective.nuisances[at].name, float(z[at]), float(z @ z)
