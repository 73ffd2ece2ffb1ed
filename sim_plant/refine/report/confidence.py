"""How surely a fitted number is known."""

from __future__ import annotations

import math

from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.fit.spread import SPREAD


def standard_deviations(fit: Fit) -> list[float]:
    """Return one per fitted number: noise and tolerances, and for sizes the model's own error.

    A size is also what is fitted later, as the mass that bounces: how large an answer is tells it.
    Where no step of any number could be simulated there is no more to say than its bounds.
    """
    noise = [math.sqrt(max(0.0, float(v))) for v in fit.covariance.diagonal()]
    if not noise:
        noise = [
            _anywhere(low, high)
            for h in fit.hypotheses
            for low, high in zip(h.low, h.high, strict=True)
        ]
    deviations: list[float] = []
    for h, values in zip(fit.hypotheses, fit.values, strict=True):
        change = {n: v - a for n, v, a in zip(h.names, values, h.absent, strict=True)}
        phasors = {name for pair in h.effect.quadratures for name in (pair.cos, pair.sin)}
        phasor = math.hypot(*(v for name, v in change.items() if name in phasors))
        for name, value in change.items():
            sized = h.effect.accepts[name].role == "strength" or name in h.effect.fitted_later
            own = phasor if name in phasors else value
            deviations.append(
                math.hypot(noise[len(deviations)], CRITERIA.report.model_share * own * sized)
            )
    return deviations


def _anywhere(low: float, high: float) -> float:
    """Return the standard deviation of a number that may lie anywhere within its bounds."""
    return (high - low) / math.sqrt(12.0) if math.isfinite(high - low) else math.pi


def interval(value: float, standard_deviation: float) -> tuple[float, float]:
    """Return low and high between which the number lies with the stated confidence."""
    spread = SPREAD * standard_deviation
    return value - spread, value + spread
