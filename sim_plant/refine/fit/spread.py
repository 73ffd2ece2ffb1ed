"""What a number's interval is made of: how many deviations, and the model's own error."""

from __future__ import annotations

import math

from scipy.special import ndtri

from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit

SPREAD = float(ndtri(0.5 + 0.5 * CRITERIA.report.confidence))
"""Standard deviations that the interval of a number reaches to either side."""


def model_errors(fit: Fit) -> list[float]:
    """Return the standard deviation of every number because no model is exact.

    ``model_share`` of its change from idle for strengths, and for what is fitted later: how
    strongly a line answers tells these too (the mass of a bouncing roll). A cosine and a sine part
    take the length of their phasor. All other numbers: 0.
    """
    errors: list[float] = []
    for h, values in zip(fit.hypotheses, fit.values, strict=True):
        change = {n: v - a for n, v, a in zip(h.names, values, h.idle, strict=True)}
        phasors = {name for pair in h.effect.quadratures for name in (pair.cos, pair.sin)}
        phasor = math.hypot(*(v for name, v in change.items() if name in phasors))
        for name, value in change.items():
            sized = h.effect.accepts[name].role == "strength" or name in h.effect.fitted_later
            own = phasor if name in phasors else abs(value)
            errors.append(CRITERIA.report.model_share * own * sized)
    return errors
