"""How surely a fitted number is known."""

from __future__ import annotations

import math

import numpy as np

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


def amplitude_standard_deviation(fit: Fit, cos: int, sin: int) -> float:
    """Return that of the length of a phasor, ``cos`` and ``sin`` its numbers in the row of all.

    Equation: u' C u along the phasor u: what only turns it says nothing of its length.
    """
    flat = [x for row in fit.values for x in row]
    both = [cos, sin]
    own = max(model_errors(fit)[k] for k in both)
    size = math.hypot(flat[cos], flat[sin])
    if not (fit.covariance.size and size > 0.0):
        return max(standard_deviations(fit)[k] for k in both)
    along = np.array([flat[cos], flat[sin]]) / size
    noise = float(along @ fit.covariance[np.ix_(both, both)] @ along)
    return math.hypot(math.sqrt(max(noise, 0.0)), own)


def _anywhere(low: float, high: float) -> float:
    """Return the standard deviation of a number that may lie anywhere within its bounds."""
    return (high - low) / math.sqrt(12.0) if math.isfinite(high - low) else math.pi


def interval(value: float, standard_deviation: float) -> tuple[float, float]:
    """Return low and high between which the number lies with the stated confidence."""
    spread = SPREAD * standard_deviation
    return value - spread, value + spread
