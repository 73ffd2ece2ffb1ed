"""Fit the numbers of effects by Gauss-Newton with a trust region, tolerances re-estimated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.model.twin import Added, Case

STRONG = 30.0
"""A nuisance whose shift moves the residual by more than this (norm) is simulated, not linear."""
ASTRAY = 50.0
"""A step that moves a declared number by this many standard deviations is not tried: that far no
slope holds, and such a line is slow to simulate or none at all."""


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
    values: tuple[tuple[float, ...], ...]
    shifts: dict[str, float]
    cost: float
    residual: Array
    covariance: Array

    @property
    def case(self) -> Case:
        """The simulation of this fit."""
        return case_of(self.hypotheses, self.values, self.shifts)

    def put(self, at: int, h: Hypothesis, values: Sequence[float]) -> Fit:
        """Return the fit with another effect in place ``at``, not fitted yet."""
        return replace(
            self,
            hypotheses=(*self.hypotheses[:at], h, *self.hypotheses[at + 1 :]),
            values=(*self.values[:at], tuple(values), *self.values[at + 1 :]),
        )

    @property
    def effects(self) -> tuple[Added, ...]:
        """The fitted effects."""
        return self.case.effects


def case_of(
    hypotheses: Sequence[Hypothesis],
    values: Sequence[Sequence[float]],
    shifts: dict[str, float],
    coarse: bool = True,
) -> Case:
    """Return the simulation of these effects and shifts."""
    effects = tuple(h.added(v) for h, v in zip(hypotheses, values, strict=True))
    return Case(effects=effects, shifts=tuple(sorted(shifts.items())), coarse=coarse)


def nominal_fit(objective: Objective, shifts: dict[str, float] | None = None) -> Fit:
    """Return the declared line itself, its strong nuisances re-estimated from ``shifts``."""
    return gauss_newton_fit(objective, (), (), shifts or {}, rounds=3)


def jacobian(
    objective: Objective,
    hypotheses: Sequence[Hypothesis],
    values: Sequence[tuple[float, ...]],
    shifts: dict[str, float],
) -> Array:
    """Return the columns of all numbers; always from coarse runs: only their zero matters."""
    cases, steps = [], []
    for at, (h, v) in enumerate(zip(hypotheses, values, strict=True)):
        for k, step in enumerate(h.steps(v)):
            moved = [tuple(x) for x in values]
            moved[at] = tuple(x + step * (j == k) for j, x in enumerate(v))
            cases.append(case_of(hypotheses, moved, shifts))
            steps.append(step)
    base, *runs = objective.pool.run([case_of(hypotheses, values, shifts), *cases])
    columns = [objective.column(r, base, s) for r, s in zip(runs, steps, strict=True)]
    rows = objective.projector.nuisances.shape[0]
    return np.stack(columns, axis=1) if columns else np.zeros((rows, 0))


def _moved_shifts(
    objective: Objective, shifts: dict[str, float], change: Array
) -> dict[str, float]:
    found = dict(shifts)
    norms = np.linalg.norm(objective.projector.nuisances[: objective.rows], axis=0)
    for row, delta, norm in zip(objective.nuisances, change, norms, strict=False):
        if abs(delta) * norm > STRONG:
            found[row.name] = found.get(row.name, 0.0) + float(delta)
    return found


def _astray(objective: Objective, shifts: dict[str, float], trial: dict[str, float]) -> bool:
    rows = zip(objective.nuisances, objective.sd, strict=True)
    return any(
        abs(trial.get(n.name, 0.0) - shifts.get(n.name, 0.0)) > ASTRAY * sd for n, sd in rows
    )


def gauss_newton_fit(
    objective: Objective,
    hypotheses: Sequence[Hypothesis],
    start: Sequence[Sequence[float]],
    shifts: dict[str, float],
    rounds: int = 6,
    coarse: bool = True,
) -> Fit:
    """Return the best fit near ``start``: linearise, step, halve the step when the cost rises.

    ``coarse`` takes the quick simulation, else the declared tick for all but the slopes.

    Raises
    ------
    PlantError
        When the start itself cannot be simulated.
    """
    hypotheses = tuple(hypotheses)
    values = [tuple(float(x) for x in v) for v in start]
    shifts = dict(shifts)
    run = objective.pool.one(case_of(hypotheses, values, shifts, coarse))
    residual = objective.residual(run, shifts, coarse)
    cost = objective.projector.cost(residual)
    covariance = np.zeros((0, 0))
    if not np.isfinite(cost):
        rounds, residual = 0, np.zeros_like(residual)
    for _ in range(rounds):
        columns = jacobian(objective, hypotheses, values, shifts)
        if not np.isfinite(columns).all():
            break
        full = objective.projector.beside(columns)
        step = full.estimate(residual)
        split = objective.projector.nuisances.shape[1]
        if columns.size:
            covariance = objective.projector.gain(residual, columns).covariance
        found = _search(
            objective, hypotheses, values, shifts, step[:split], step[split:], cost, coarse
        )
        if found is None:
            break
        values, shifts, run, residual, new_cost = found
        gained, cost = cost - new_cost, new_cost
        if gained < max(1.0, 1e-4 * cost):
            break
    return Fit(
        hypotheses=hypotheses,
        values=tuple(values),
        shifts=shifts,
        cost=cost,
        residual=objective.projector.project(residual),
        covariance=covariance,
    )


_Found = tuple[list[tuple[float, ...]], dict[str, float], list[Array], Array, float]


def _search(
    objective: Objective,
    hypotheses: Sequence[Hypothesis],
    values: Sequence[tuple[float, ...]],
    shifts: dict[str, float],
    nuisance_step: Array,
    step: Array,
    cost: float,
    coarse: bool,
) -> _Found | None:
    for share in (1.0, 0.4, 0.15, 0.05):
        at, moved = 0, []
        for h, v in zip(hypotheses, values, strict=True):
            raw = np.array(v) + share * step[at : at + len(v)]
            moved.append(tuple(float(x) for x in np.clip(raw, h.low, h.high)))
            at += len(v)
        trial = _moved_shifts(objective, shifts, share * nuisance_step)
        if moved == list(values) and trial == shifts:
            return None
        if _astray(objective, shifts, trial):
            continue
        try:
            run = objective.pool.one(case_of(hypotheses, moved, trial, coarse))
        except PlantError:
            continue
        residual = objective.residual(run, trial, coarse)
        new_cost = objective.projector.cost(residual)
        if new_cost < cost:
            return moved, trial, run, residual, new_cost
    return None
