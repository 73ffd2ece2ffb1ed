"""Fit the numbers of effects by Gauss-Newton with step shortening, tolerances re-estimated."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.model.nuisances import is_effective_radius
from sim_plant.refine.model.twin import Added, Case

FIT, COMPLETENESS = CRITERIA.fit, CRITERIA.search.completeness

Values = tuple[tuple[float, ...], ...]
"""Numbers of every effect, in order."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Fit:
    """Effects with fitted numbers.

    Attributes
    ----------
    hypotheses, values : effects and their numbers, in order.
    shifts : declared numbers moved with them.
    cost : least cost.
    residual : projected residual vector.
    covariance : of all values in a row.
    """

    hypotheses: tuple[Hypothesis, ...]
    values: Values
    shifts: dict[str, float]
    cost: float
    residual: Array
    covariance: Array

    @property
    def case(self) -> Case:
        """The simulation of this fit."""
        return case_of(self.hypotheses, self.values, self.shifts)

    @property
    def effects(self) -> tuple[Added, ...]:
        """The fitted effects."""
        return self.case.effects

    def with_effect_at(self, at: int, h: Hypothesis, values: Sequence[float]) -> Fit:
        """Return the fit with another effect in place ``at``, not fitted yet."""
        return replace(
            self,
            hypotheses=(*self.hypotheses[:at], h, *self.hypotheses[at + 1 :]),
            values=(*self.values[:at], tuple(values), *self.values[at + 1 :]),
        )

    def without_effect_at(self, at: int) -> Fit:
        """Return the fit without effect ``at``, all other numbers as they are."""
        sizes = [len(row) for row in self.values]
        first = sum(sizes[:at])
        gone = slice(first, first + sizes[at])
        known = np.delete(np.delete(self.covariance, gone, axis=0), gone, axis=1)
        return replace(
            self,
            hypotheses=(*self.hypotheses[:at], *self.hypotheses[at + 1 :]),
            values=(*self.values[:at], *self.values[at + 1 :]),
            covariance=known if self.covariance.size else self.covariance,
        )


def case_of(
    hypotheses: Sequence[Hypothesis],
    values: Sequence[Sequence[float]],
    shifts: Mapping[str, float],
    quick: bool = True,
) -> Case:
    """Return the simulation of these effects and shifts."""
    effects = tuple(h.added(v) for h, v in zip(hypotheses, values, strict=True))
    return Case(effects=effects, shifts=tuple(sorted(shifts.items())), quick=quick)


def nominal_fit(objective: Objective, shifts: dict[str, float] | None = None) -> Fit:
    """Return the declared line itself, its strong nuisances re-estimated from ``shifts``."""
    return gauss_newton_fit(objective, (), (), shifts or {}, rounds=FIT.rounds_again)


def jacobian(
    objective: Objective,
    hypotheses: Sequence[Hypothesis],
    values: Values,
    shifts: dict[str, float],
) -> Array:
    """Return the whitened derivatives (rows, numbers) by all numbers, from quick runs always.

    Where the line does not run a step further on (a web that cannot follow a shape), the step is
    taken the other way.
    """
    steps = _increments(hypotheses, values)

    def moved(at: int, k: int, increment: float) -> Case:
        return _stepped_case(hypotheses, values, shifts, at, k, increment)

    base, *runs = objective.pool.run(
        [case_of(hypotheses, values, shifts), *(moved(*step) for step in steps)]
    )
    broken = [n for n, run in enumerate(runs) if not all(np.isfinite(y).all() for y in run)]
    for n in broken:
        at, k, increment = steps[n]
        steps[n] = (at, k, -increment)
    for n, run in zip(broken, objective.pool.run([moved(*steps[n]) for n in broken]), strict=True):
        runs[n] = run
    rows = objective.projector.nuisances.shape[0]
    increments = [increment for _, _, increment in steps]
    return objective.columns(runs, base, increments) if runs else np.zeros((rows, 0))


def _increments(hypotheses: Sequence[Hypothesis], values: Values) -> list[tuple[int, int, float]]:
    """Return the finite-difference steps: place of the effect, of its number, and increment."""
    return [
        (at, k, increment)
        for at, (h, v) in enumerate(zip(hypotheses, values, strict=True))
        for k, increment in enumerate(h.increments(v))
    ]


def _stepped_case(
    hypotheses: Sequence[Hypothesis],
    values: Values,
    shifts: Mapping[str, float],
    at: int,
    k: int,
    increment: float,
) -> Case:
    """Return the simulation with number ``k`` of effect ``at`` one step further on."""
    there = list(values)
    there[at] = tuple(x + increment * (j == k) for j, x in enumerate(values[at]))
    return case_of(hypotheses, there, shifts)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Point:
    """Numbers of effects and shifts that were simulated, with what they leave."""

    values: Values
    shifts: dict[str, float]
    residual: Array
    cost: float


def gauss_newton_fit(
    objective: Objective,
    hypotheses: Sequence[Hypothesis],
    start: Sequence[Sequence[float]],
    shifts: dict[str, float],
    rounds: int = FIT.rounds,
    quick: bool = True,
) -> Fit:
    """Return the best fit near ``start``: linearise, step, shorten a step that does not improve.

    ``quick`` takes the quick simulation, else the declared tick for all but the slopes. With no
    ``rounds`` the start is weighed as it is.

    Raises
    ------
    PlantError
        When the start itself cannot be simulated.
    """
    hypotheses = tuple(hypotheses)
    values = tuple(tuple(float(x) for x in v) for v in start)
    here = _simulated(objective, hypotheses, values, dict(shifts), quick, slopes=rounds > 0)
    covariance = np.zeros((0, 0))
    if not np.isfinite(here.cost):
        rounds, here = 0, replace(here, residual=np.zeros_like(here.residual))
    for turn in range(1, rounds + 1):
        columns = jacobian(objective, hypotheses, here.values, here.shifts)
        if not np.isfinite(columns).all():
            break
        step = objective.projector.joint_estimate(here.residual, columns)
        if columns.size:
            covariance = objective.projector.linear_fit(here.residual, columns).covariance
        better = _stepped(objective, hypotheses, here, step, quick, slopes=turn < rounds)
        if better is None:
            break
        gained, here = here.cost - better.cost, better
        if gained < max(FIT.least_gain, FIT.least_gain_share * here.cost):
            break
    return Fit(
        hypotheses=hypotheses,
        values=here.values,
        shifts=here.shifts,
        cost=here.cost,
        residual=objective.projector.project(here.residual),
        covariance=covariance,
    )


def _simulated(
    objective: Objective,
    hypotheses: Sequence[Hypothesis],
    values: Values,
    shifts: dict[str, float],
    quick: bool,
    *,
    slopes: bool = False,
) -> _Point:
    """Return a point; with ``slopes`` the runs that its `jacobian` needs are made beside it.

    One line alone takes nearly as long as four in lanes, and a point that is kept needs them next.
    """
    case = case_of(hypotheses, values, shifts, quick)
    if slopes and quick:
        steps = _increments(hypotheses, values)
        beside = [_stepped_case(hypotheses, values, shifts, *step) for step in steps]
        run = objective.pool.run([case, *beside])[0]
    else:
        run = objective.pool.one(case)
    residual = objective.residual(run, shifts, quick)
    cost = objective.projector.cost(residual)
    return _Point(values=values, shifts=shifts, residual=residual, cost=cost)


def _stepped(
    objective: Objective,
    hypotheses: Sequence[Hypothesis],
    here: _Point,
    step: Array,
    quick: bool,
    *,
    slopes: bool,
) -> _Point | None:
    """Return the first point along ``step`` (nuisances, then numbers) that costs less, or None.

    A step that takes declared numbers, together, beyond their tolerances is compared with the same
    step without them: they stay where they are, what they would explain counts linearly, and an
    effect that they imitate can still be found. They move where nothing is left then beyond noise,
    or where moving them explains ``fair_share`` of what is left: then they are the cause.
    """
    there = _shortened(objective, hypotheses, here, step, quick, slopes=slopes)
    split = objective.projector.nuisances.shape[1]
    if there is None or _within_tolerances(objective, here.shifts, step[:split]):
        return there
    held = step.copy()
    held[:split] = 0.0
    still = _shortened(objective, hypotheses, here, held, quick)
    stay = here if still is None else still
    rest = objective.projector.project(stay.residual)
    price = float(np.sum(rest[objective.rows :] ** 2))  # of the shifts, by their tolerances
    left = objective.excess(stay.cost - price, rest)
    left -= COMPLETENESS.sure_sd * objective.cost_standard_deviation
    fair = COMPLETENESS.fair_share * max(left, 0.0)
    return there if stay.cost - there.cost > fair else still


def _within_tolerances(objective: Objective, shifts: Mapping[str, float], change: Array) -> bool:
    """Return whether shifts, moved by ``change``, are together within what tolerances admit.

    Effective radii do not count: the recorded angle of a roll fixes its own.
    """
    rows = zip(objective.nuisances, change, objective.prior_sd, strict=False)
    z = np.array(
        [
            (shifts.get(n.name, 0.0) + float(delta)) / sd
            for n, delta, sd in rows
            if not is_effective_radius(n.name)
        ]
    )
    return is_tolerance(z)


def is_tolerance(z: Array) -> bool:
    """Return whether shifts (n,), in prior standard deviations, are what tolerances admit.

    Equation: z' z < n + k sqrt(2 n), k ``joint_sd``.
    """
    widest = CRITERIA.search.degeneracy.joint_sd
    return not z.size or float(z @ z) < z.size + widest * math.sqrt(2.0 * z.size)


def _shortened(
    objective: Objective,
    hypotheses: Sequence[Hypothesis],
    here: _Point,
    step: Array,
    quick: bool,
    *,
    slopes: bool = False,
) -> _Point | None:
    """Return the first point along ``step`` that costs less, or None.

    Where the whole step does not, its shares are simulated together: three lines side by side
    take little longer than one.
    """
    trials = list(_trials(objective, hypotheses, here, step))
    for at, (share, values, shifts) in enumerate(trials):
        if at == 1:
            rest = [case_of(hypotheses, v, s, quick) for _, v, s in trials[1:]]
            objective.pool.run(rest)
        try:
            first = slopes and share == FIT.step_shares[0]
            there = _simulated(objective, hypotheses, values, shifts, quick, slopes=first)
        except PlantError:
            continue
        if there.cost < here.cost:
            return there
    return None


def _trials(
    objective: Objective, hypotheses: Sequence[Hypothesis], here: _Point, step: Array
) -> Iterator[tuple[float, Values, dict[str, float]]]:
    """Yield shares of a step with the numbers and shifts there, until none is moved any more."""
    split = objective.projector.nuisances.shape[1]
    for share in FIT.step_shares:
        values = _moved(hypotheses, here.values, share * step[split:])
        shifts = _moved_shifts(objective, here.shifts, share * step[:split])
        if values == here.values and shifts == here.shifts:
            return
        if not _astray(objective, here.shifts, shifts):
            yield share, values, shifts


def _moved(hypotheses: Sequence[Hypothesis], values: Values, change: Array) -> Values:
    """Return numbers moved by ``change``, kept within their bounds."""
    at, moved = 0, []
    for h, v in zip(hypotheses, values, strict=True):
        raw = np.array(v) + change[at : at + len(v)]
        moved.append(tuple(float(x) for x in np.clip(raw, h.low, h.high)))
        at += len(v)
    return tuple(moved)


def _moved_shifts(
    objective: Objective, shifts: dict[str, float], change: Array
) -> dict[str, float]:
    """Return shifts with those moved that are strong enough to be simulated."""
    moved = dict(shifts)
    norms = objective.projector.sizes(objective.rows)
    for row, delta, norm in zip(objective.nuisances, change, norms, strict=False):
        if abs(delta) * norm > FIT.simulated_norm:
            moved[row.name] = moved.get(row.name, 0.0) + float(delta)
    return moved


def _astray(objective: Objective, shifts: dict[str, float], trial: dict[str, float]) -> bool:
    """Return whether a step moves a declared number by more than ``astray_sd``."""
    return any(
        abs(trial.get(n.name, 0.0) - shifts.get(n.name, 0.0)) > FIT.astray_sd * 0.5 * n.tolerance
        for n in objective.nuisances
    )
