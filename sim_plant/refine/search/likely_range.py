"""Between which ends a number of an effect may lie, all others fitted again at either.

A covariance gives them where the line answers to a number in proportion, but not where an effect
begins at a threshold, counts in ticks, or does not show at all: play in a shaft whose torque never
turns. There the number is held at one value after another, and the interval ends where the cost
has risen by as much as its confidence admits.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit, Values, case_of
from sim_plant.refine.fit.objective import Objective

RANGES = CRITERIA.report.ranges


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Held:
    """A fit with one number held elsewhere.

    Attributes
    ----------
    cost : chi-square with all others fitted again; infinite where the line does not run.
    values : all numbers of the fit in a row (q,).
    residual : what is left with them (rows,); None where the line does not run with them.
    """

    cost: float
    values: Array
    residual: Array | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LikelyRange:
    """Where a number may lie.

    Attributes
    ----------
    low, high : ends of the interval.
    lowest, highest : least and greatest value of all numbers while this one is within it (q,).
    best : the fit of least cost that was met on the way.
    """

    low: float
    high: float
    lowest: Array
    highest: Array
    best: Held


def likely_range(
    objective: Objective, fit: Fit, columns: Array, at: int, *, width: float, rise: float
) -> LikelyRange:
    """Return between which ends number ``at`` of all (in a row) lies.

    Parameters
    ----------
    columns : change of the whitened residual per number, at ``fit`` (rows, q).
    width : expected distance of either end from the fitted value.
    rise : rise of the cost at the ends, chi-square.
    """
    flat = _flat(fit.values)
    low = np.concatenate([h.low for h in fit.hypotheses])
    high = np.concatenate([h.highest for h in fit.hypotheses])
    quick = not in_ticks(fit)
    start = _held(objective, fit, flat, quick)
    seen = [start]

    def rise_at(value: float) -> float:
        near = min(seen, key=lambda s: abs(float(s.values[at]) - value))
        there = near.values.copy()
        there[at] = value
        found = refitted(objective, fit, columns, there, at, quick)
        if found.cost - start.cost <= (1.0 + RANGES.near_share) * rise:
            seen.append(found)
        return found.cost - start.cost

    ends = [
        end_of(
            lambda far, sign=sign: rise_at(float(flat[at]) + sign * far),  # type: ignore[misc]
            width,
            furthest=abs(float(bound) - float(flat[at])),
            limit=rise,
        )
        for sign, bound in ((-1.0, low[at]), (1.0, high[at]))
    ]
    rows = np.stack([s.values for s in seen])
    return LikelyRange(
        low=float(flat[at]) - ends[0],
        high=float(flat[at]) + ends[1],
        lowest=rows.min(axis=0),
        highest=rows.max(axis=0),
        best=min(seen, key=lambda s: s.cost),
    )


def end_of(
    rise: Callable[[float], float], width: float, *, furthest: float, limit: float
) -> float:
    """Return the distance at which a cost has risen by ``limit``, ``furthest`` at most.

    ``rise`` gives it by the distance, ``width`` is where the end is expected. Between two points
    the cost is taken to grow with the square of the distance.
    """
    inside, outside = (0.0, 0.0), (math.inf, math.inf)
    far = min(width, furthest)
    for _ in range(RANGES.looks):
        here = rise(far)
        if here <= limit:
            inside = far, max(here, 0.0)
        else:
            outside = far, here
        if inside[0] >= furthest:
            return furthest
        if (
            abs(here - limit) < RANGES.near_share * limit
            or inside[0] > RANGES.between_share * outside[0]
        ):
            break
        far = min(2.0 * far, furthest)
        if math.isfinite(outside[0]):
            far = 0.5 * (inside[0] + outside[0])
    most = math.sqrt(limit)
    low, high = math.sqrt(inside[1]), math.sqrt(outside[1])
    if math.isfinite(high):
        share = (most - low) / max(high - low, 1e-12)
        return inside[0] + min(max(share, 0.0), 1.0) * (outside[0] - inside[0])
    if math.isfinite(outside[0]):
        return inside[0]
    return min(furthest, inside[0] * most / max(low, 1e-12))


def refitted(
    objective: Objective, fit: Fit, columns: Array, start: Array, at: int, quick: bool
) -> Held:
    """Return the fit with number ``at`` held where ``start`` has it, all others fitted again.

    Steps follow the slopes ``columns``, those at the fit, as long as the cost falls.
    """
    others = [k for k in range(start.size) if k != at]
    here = _held(objective, fit, start, quick)
    for _ in range(RANGES.corrections if others else 0):
        if here.residual is None:
            break
        estimate = objective.projector.joint_estimate(here.residual, columns[:, others])
        step = estimate[-len(others) :]
        moved = here.values.copy()
        moved[others] += step
        there = _held(objective, fit, moved, quick)
        if not there.cost < here.cost:
            break
        gained, here = here.cost - there.cost, there
        if gained < CRITERIA.fit.least_gain:
            break
    return here


def in_ticks(fit: Fit) -> bool:
    """Return whether a number of a fit is known to a drive tick: a quick one is too long then."""
    return any(
        h.effect.accepts[name].known_to == "drive tick" for h in fit.hypotheses for name in h.names
    )


def values_of(fit: Fit, flat: Array) -> Values:
    """Return numbers in a row as those of every effect, within their bounds."""
    found, at = [], 0
    for h in fit.hypotheses:
        raw = flat[at : at + len(h.names)]
        found.append(tuple(float(x) for x in np.clip(raw, h.low, h.high)))
        at += len(h.names)
    return tuple(found)


def _held(objective: Objective, fit: Fit, flat: Array, quick: bool) -> Held:
    """Return what these numbers (q,) cost and leave, within their bounds, nothing fitted."""
    residual = _residual(objective, fit, flat, quick)
    cost = math.inf if residual is None else objective.projector.cost(residual)
    return Held(cost=cost, values=_flat(values_of(fit, flat)), residual=residual)


def _residual(objective: Objective, fit: Fit, flat: Array, quick: bool) -> Array | None:
    """Return what is left with these numbers; None where the line does not run with them."""
    case = case_of(fit.hypotheses, values_of(fit, flat), fit.shifts, quick)
    try:
        run = objective.pool.one(case)
    except PlantError:
        return None
    residual = objective.residual(run, fit.shifts, quick)
    return residual if np.isfinite(residual).all() else None


def _flat(values: Values) -> Array:
    """Return the numbers of all effects in a row (q,)."""
    found: Array = np.array([x for row in values for x in row], dtype=np.float64)
    return found
