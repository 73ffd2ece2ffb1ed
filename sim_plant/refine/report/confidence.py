"""How surely a fitted number is known."""

from __future__ import annotations

import math

from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.fit.spread import SPREAD, model_errors


def standard_deviations(fit: Fit) -> list[float]:
    """Return one per fitted number: noise and tolerances, and for sizes the model's own error.

    Where no step of any number could be simulated there is no more to say than its bounds.
    """
    noise = [math.sqrt(max(0.0, float(v))) for v in fit.covariance.diagonal()]
    if not noise:
        noise = [
            _anywhere(low, high)
            for h in fit.hypotheses
            for low, high in zip(h.low, h.high, strict=True)
        ]
    return [math.hypot(*both) for both in zip(noise, model_errors(fit), strict=True)]


def _anywhere(low: float, high: float) -> float:
    """Return the standard deviation of a number that may lie anywhere within its bounds."""
    return (high - low) / math.sqrt(12.0) if math.isfinite(high - low) else math.pi


def interval(value: float, standard_deviation: float) -> tuple[float, float]:
    """Return low and high between which the number lies with the stated confidence."""
    spread = SPREAD * standard_deviation
    return value - spread, value + spread
