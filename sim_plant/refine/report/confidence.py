"""Standard deviations and intervals of fitted numbers."""

from __future__ import annotations

import math

import numpy as np

from sim_plant.base.effects import Quadrature
from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.fit.spread import SPREAD, model_errors
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.search.selection import Selection


def standard_deviations(fit: Fit) -> list[float]:
    """Return the standard deviation of every fitted number, in its own unit.

    From noise and tolerances, and for sizes the model's own error. Without a covariance (no step
    of any number could be simulated) that of a number anywhere within its bounds.
    """
    noise = [math.sqrt(max(0.0, float(v))) for v in fit.covariance.diagonal()]
    if not noise:
        noise = [
            _anywhere(low, high)
            for h in fit.hypotheses
            for low, high in zip(h.low, h.high, strict=True)
        ]
    return [math.hypot(*both) for both in zip(noise, model_errors(fit), strict=True)]


def amplitude_standard_deviation(fit: Fit, cos_index: int, sin_index: int) -> float:
    """Return the standard deviation of a phasor's length, in the unit of its parts.

    Equation: variance u' C u, u the unit vector along the phasor, C the covariance of its parts.

    Parameters
    ----------
    cos_index, sin_index : of its parts, in the row of all fitted numbers.
    """
    flat = [x for row in fit.values for x in row]
    both = [cos_index, sin_index]
    model_error = max(model_errors(fit)[k] for k in both)
    length = math.hypot(flat[cos_index], flat[sin_index])
    if not (fit.covariance.size and length > 0.0):
        return max(standard_deviations(fit)[k] for k in both)
    along = np.array([flat[cos_index], flat[sin_index]]) / length
    variance = float(along @ fit.covariance[np.ix_(both, both)] @ along)
    return math.hypot(math.sqrt(max(variance, 0.0)), model_error)


def phasors(fit: Fit, h: Hypothesis, at: int) -> list[tuple[Quadrature, float]]:
    """Return the phasors of an effect of which both parts were fitted.

    Each with the standard deviation of its length.

    Parameters
    ----------
    at : index of the effect's first number in the row of all fitted numbers.
    """
    index = {name: at + k for k, name in enumerate(h.names)}
    return [
        (pair, amplitude_standard_deviation(fit, index[pair.cos], index[pair.sin]))
        for pair in h.effect.quadratures
        if pair.cos in index and pair.sin in index
    ]


def sizes_shown(selection: Selection) -> list[bool]:
    """Return per effect whether the records show that it has a size at all.

    One of its strengths, or the length of a phasor, has an interval that leaves out the value at
    which the effect has no trace. Where none has, the effect can be absent for all that its own
    numbers say, however much better the fit is with it: something else has its place there.
    Without a covariance no step ran, and the scores alone speak. An effect without strengths has
    no size to doubt.
    """
    fit, sd, at = selection.fit, standard_deviations(selection.fit), 0
    if not fit.covariance.size:
        return [True] * len(fit.hypotheses)
    shown = []
    ranges = selection.ranges or ({},) * len(fit.hypotheses)
    for h, values, known in zip(fit.hypotheses, fit.values, ranges, strict=True):
        rows = zip(h.names, values, sd[at : at + len(values)], strict=True)
        ends = {name: known.get(name, interval(value, own_sd)) for name, value, own_sd in rows}
        idle_strengths = list(zip(h.names, h.idle, strict=True))[: h.strength_count]
        is_size = [not ends[name][0] <= idle <= ends[name][1] for name, idle in idle_strengths]
        value_of = dict(zip(h.names, values, strict=True))
        for pair, length_sd in phasors(fit, h, at):
            low, _ = interval(math.hypot(value_of[pair.cos], value_of[pair.sin]), length_sd)
            is_size.append(low > 0.0)
        shown.append(any(is_size) or not idle_strengths)
        at += len(values)
    return shown


def _anywhere(low: float, high: float) -> float:
    """Return the standard deviation of a number anywhere within its bounds.

    pi where a bound is infinite: only angles have none.
    """
    return (high - low) / math.sqrt(12.0) if math.isfinite(high - low) else math.pi


def interval(value: float, standard_deviation: float) -> tuple[float, float]:
    """Return low and high of a number's interval of confidence ``CRITERIA.report.confidence``."""
    spread = SPREAD * standard_deviation
    return value - spread, value + spread
