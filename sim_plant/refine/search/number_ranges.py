"""Intervals of all numbers of the effects found, once the search is over.

A walk is one `likely_range`: the ends of one number, sought with all others fitted again.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.special import stdtrit

from sim_plant.base.arrays import Array
from sim_plant.base.signatures import Frequency
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit, gauss_newton_fit, jacobian
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.fit.robust_covariance import MANY, moved_by_declared, robust_covariance
from sim_plant.refine.fit.spread import SPREAD, model_errors
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.search.likely_range import LikelyRange, likely_range, values_of
from sim_plant.refine.search.moment_range import is_plain_moment, moment_range
from sim_plant.refine.search.profile_age import with_numbers
from sim_plant.refine.search.selection import Ranges, Selection
from sim_plant.refine.search.wandering import weighed_with_wander

REPORT = CRITERIA.report


def with_number_ranges(objective: Objective, selection: Selection) -> Selection:
    """Return the selection with an interval for each of its numbers.

    It follows from the covariance; for numbers to which the line does not answer in proportion,
    from a walk. Numbers that explain more, met on a walk, become the fit. Where a size is not
    quite constant, all is by a fit that lets it wander (`weighed_with_wander`).
    """
    weighed = weighed_with_wander(objective, selection.fit)
    if weighed is objective:
        return _with_ranges(objective, selection)
    fit = selection.fit
    known = gauss_newton_fit(weighed, fit.hypotheses, fit.values, fit.shifts, quick=False)
    ranged = _with_ranges(weighed, replace(selection, fit=known))
    known = ranged.fit
    plain = gauss_newton_fit(
        objective, known.hypotheses, known.values, known.shifts, rounds=0, quick=False
    )
    return replace(ranged, fit=replace(plain, covariance=known.covariance))


def _with_ranges(objective: Objective, selection: Selection) -> Selection:
    """Return the selection with intervals; without, where its slopes cannot be simulated."""
    for _ in range(REPORT.ranges.passes):
        fit = selection.fit
        columns = jacobian(objective, fit.hypotheses, fit.values, fit.shifts)
        if not fit.hypotheses or not np.isfinite(columns).all():
            return selection
        noise = objective.projector.linear_fit(fit.residual, columns).covariance
        explained = [a.score for a in selection.accepted]
        known = with_covariance(objective, fit, columns, explained)
        ends = _Ends(known)
        walks = _walks(objective, known, columns, noise.diagonal(), ends)
        better = _better(objective, known, walks)
        if better is not None:
            selection = replace(selection, fit=better)
            continue
        for at, h in enumerate(fit.hypotheses):
            for name in hidden(h):
                ends.take_hidden(*_hidden_walk(objective, known, at, name, explained[at]))
        return replace(selection, fit=known, ranges=ends.ranges(objective))
    return selection


def with_covariance(
    objective: Objective, fit: Fit, columns: Array, explained: Sequence[float]
) -> Fit:
    """Return the fit with a covariance of noise, tolerances, model error, and wander.

    ``SPREAD`` of its standard deviations hold a number with the stated confidence: a variance of
    few degrees of freedom (`robust_covariance`) is widened to Student's t of the whole variance.
    The response to an effect may be wrong by the share e: that moves any number of it by up to
    e sqrt(X) of its deviation in noise, where X is the chi-square that the effect explains; a
    size by e of itself (``model_errors``, not part of this covariance). A declared number that
    was moved beyond tolerance may move others: their intervals reach to where they are without
    that move (`moved_by_declared`).
    Equation: v = sum v_i, freedom v^2 / sum (v_i^2 / f_i)  [Satterthwaite 1946].
    """
    robust = robust_covariance(objective, columns, fit.residual)
    plain = np.maximum(robust.noise.diagonal(), 0.0)
    counts = [len(row) for row in fit.values]
    share = REPORT.model_share * np.sqrt(np.repeat(np.maximum(explained, 0.0), counts))
    wrong = np.where(np.array(model_errors(fit)) > 0.0, 0.0, share**2 * plain)
    part = np.where(plain > 0.0, plain, 1.0)
    moved = np.sqrt((robust.variance + wrong) / part)
    covariance = robust.noise * np.outer(moved, moved) + robust.tolerances
    total = np.maximum(covariance.diagonal(), 1e-300) + np.square(model_errors(fit))
    grown = total / np.maximum(robust.variance, 1e-300)
    freedom = np.minimum(robust.degrees_of_freedom * grown**2, MANY)
    wide = stdtrit(freedom, 0.5 + 0.5 * REPORT.confidence) / SPREAD
    taken = moved_by_declared(objective, fit.residual, columns) / SPREAD
    wider = covariance * np.outer(wide, wide) + np.outer(taken, taken)
    return replace(fit, covariance=wider)


class _Ends:
    """Ends of the intervals of all numbers of a fit, as they are found."""

    def __init__(self, fit: Fit) -> None:
        self.fit = fit
        self.found = np.array([x for row in fit.values for x in row])
        known = np.maximum(fit.covariance.diagonal(), 0.0)
        self.sd = np.hypot(np.sqrt(known), model_errors(fit))
        self.low, self.high = self.found - SPREAD * self.sd, self.found + SPREAD * self.sd
        self.hidden: list[tuple[int, str, tuple[float, float]]] = []

    def take(self, walk: LikelyRange, k: int) -> None:
        """Take the ends of number ``k``; intervals of others widen to their values on the walk."""
        self._reach(walk.lowest, walk.highest)
        self.low[k], self.high[k] = walk.low, walk.high

    def take_hidden(self, at: int, name: str, walk: LikelyRange, k: int) -> None:
        """Take the ends of a number of effect ``at`` not fitted, number ``k`` of its walk."""
        self.hidden.append((at, name, (walk.low, walk.high)))
        self._reach(np.delete(walk.lowest, k), np.delete(walk.highest, k))

    def _reach(self, lowest: Array, highest: Array) -> None:
        self.low = np.minimum(self.low, lowest)
        self.high = np.maximum(self.high, highest)

    def ranges(self, objective: Objective) -> tuple[Ranges, ...]:
        """Return the intervals by effect and name, no narrower than ``known_to`` allows."""
        found: list[dict[str, tuple[float, float]]] = [{} for _ in self.fit.hypotheses]
        for k, (at, name) in enumerate(numbers_of(self.fit)):
            # standard deviation of what is spread evenly over known_to to either side
            grain = SPREAD * known_to(objective, self.fit.hypotheses[at], name) / math.sqrt(3.0)
            value = float(self.found[k])
            below = math.hypot(value - float(self.low[k]), grain)
            found[at][name] = value - below, value + math.hypot(float(self.high[k]) - value, grain)
        for at, name, interval in self.hidden:
            found[at][name] = interval
        return tuple(found)


def _walks(
    objective: Objective, fit: Fit, columns: Array, noise: Array, ends: _Ends
) -> list[LikelyRange]:
    """Return the walks of all ``uneven`` numbers that the records show, and take their ends."""
    walks = []
    for k, (at, name) in enumerate(numbers_of(fit)):
        if not (uneven(fit.hypotheses[at], name) and noise[k] > 0.0):
            continue
        width = SPREAD * float(ends.sd[k])
        rise = width**2 / float(noise[k])
        if is_plain_moment(fit.hypotheses[at], name):
            walk = moment_range(objective, fit, columns, k, at, rise / SPREAD**2)
        else:
            walk = likely_range(objective, fit, columns, k, width=width, rise=rise)
        ends.take(walk, k)
        walks.append(walk)
    return walks


def _better(objective: Objective, fit: Fit, walks: Sequence[LikelyRange]) -> Fit | None:
    """Return a fit from the best numbers met on the walks, where it costs less by the margin."""
    least = fit.cost - CRITERIA.search.acceptance.margin
    for walk in sorted(walks, key=lambda w: w.best.cost):
        there = values_of(fit, walk.best.values)
        if walk.best.cost > least or there == fit.values:
            return None
        found = gauss_newton_fit(
            objective,
            fit.hypotheses,
            there,
            fit.shifts,
            rounds=CRITERIA.fit.rounds_near,
            quick=False,
        )
        if found.cost < least:
            return found
    return None


def _hidden_walk(
    objective: Objective, fit: Fit, at: int, name: str, explained: float
) -> tuple[int, str, LikelyRange, int]:
    """Return effect, name and walk of a number that is not fitted, and its index in the walk."""
    h = fit.hypotheses[at]
    row, value = h.effect.accepts[name], float(dict(h.fixed)[name])
    wider = with_numbers(objective, fit, at, (name,), {name: value})
    free = wider.hypotheses[at]
    sizes = zip(free.names, free.start, strict=True)
    free = replace(free, start=tuple(row.typical if n == name else s for n, s in sizes))
    wider = wider.with_effect_at(at, free, wider.values[at])
    columns = jacobian(objective, wider.hypotheses, wider.values, wider.shifts)
    k = numbers_of(wider).index((at, name))
    scale = abs(row.typical - float(row.default))
    width, rise = scale, SPREAD**2 * (1.0 + REPORT.model_share**2 * max(explained, 0.0))
    if np.isfinite(columns).all():
        noise = float(objective.projector.linear_fit(fit.residual, columns).covariance[k, k])
        width = min(max(math.sqrt(max(rise * noise, 0.0)), REPORT.first_step_share * scale), scale)
    else:
        columns = np.where(np.isfinite(columns), columns, 0.0)
    walk = likely_range(objective, wider, columns, k, width=width, rise=rise)
    return at, name, walk, k


def numbers_of(fit: Fit) -> list[tuple[int, str]]:
    """Return index of effect and name of every number of a fit, in a row."""
    return [(at, name) for at, h in enumerate(fit.hypotheses) for name in h.names]


def uneven(h: Hypothesis, name: str) -> bool:
    """Return whether the line does not answer in proportion to a number of an effect.

    Never of effects at orders of a body, or at a frequency: many turns determine their numbers
    so well that the line answers in proportion within the interval.
    """
    row = h.effect.accepts[name]
    steady = h.effect.order_locked or isinstance(h.effect.shows, Frequency)
    return not (steady or row.linear) and row.role in ("strength", "shape")


def hidden(h: Hypothesis) -> list[str]:
    """Return the numbers of an effect that the search left out because no record showed them.

    Strengths that are absent, and numbers that are fitted only later (``fitted_later``).
    """
    return [
        name
        for name, value in h.fixed
        if name in h.effect.fitted_later
        or (h.effect.accepts[name].role == "strength" and value == h.effect.accepts[name].default)
    ]


def known_to(objective: Objective, h: Hypothesis, name: str) -> float:
    """Return how exactly, to either side, a record can show a number at best, in its unit."""
    row = h.effect.accepts[name]
    twin = objective.pool.twins[h.record_index or 0]
    if row.known_to == "drive tick":
        return float(twin.declaration.control.drive_sample_time_s)
    if row.known_to == "sample":
        sample_s = float(twin.declaration.sample_time_s)
        return sample_s * (float(np.mean(np.abs(twin.speed_m_s))) if row.unit == "m" else 1.0)
    return row.known_to
