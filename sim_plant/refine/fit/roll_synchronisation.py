"""Simulated rolls synchronised with the measured ones.

A radius wrong by 0.05 % puts a roll a quarter radian out of step in 80 turns: enough to lose
every harmonic. What an effect does at a roll's angle can only be found in step with that angle.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit, case_of, gauss_newton_fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.model.nuisances import declared_nuisances, effective_radius_of
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.model.twin import Case, Twin

FIT = CRITERIA.fit


def synchronising_shifts(
    objective: Objective,
    shifts: Mapping[str, float],
    hypotheses: Sequence[Hypothesis] = (),
    values: Sequence[Sequence[float]] = (),
) -> dict[str, float]:
    """Return ``shifts`` with effective radii at which simulated rolls turn as the measured ones.

    Rounds of simulation: a shift is a length, so its share of the radius grows as a roll is
    unwound. Rolls count of which an angle or a speed in rad/s is recorded.
    """
    twins = objective.pool.twins
    measured = [recorded_angles(t, m) for t, m in zip(twins, objective.measured, strict=True)]

    def too_fast(moved: Mapping[str, float]) -> dict[str, float]:
        runs = objective.pool.one(case_of(hypotheses, values, moved))
        return _slope_errors(objective, runs, measured)

    return _moved_into_step(shifts, too_fast)


def _moved_into_step(
    shifts: Mapping[str, float], too_fast: Callable[[Mapping[str, float]], Mapping[str, float]]
) -> dict[str, float]:
    """Return the shifts moved round by round, until no roll turns too fast or the line breaks."""
    moved = dict(shifts)
    for _ in range(FIT.in_step_rounds):
        moves = too_fast(moved)
        if not moves or not np.isfinite(list(moves.values())).all():
            break
        for name, move in moves.items():
            moved[name] = moved.get(name, 0.0) + move
    return moved


def synchronised(objective: Objective, fit: Fit) -> Fit:
    """Return the fit with its rolls in step; its cost is that there."""
    shifts = synchronising_shifts(objective, fit.shifts, fit.hypotheses, fit.values)
    if shifts == fit.shifts:
        return fit
    return gauss_newton_fit(objective, fit.hypotheses, fit.values, shifts, rounds=0, quick=False)


def shifts_in_step(
    pool: SimulationPool, measured: Array, case: Case, first: int
) -> tuple[tuple[str, float], ...]:
    """Return the shifts of ``case`` with effective radii at which wound rolls turn as measured.

    As ``synchronising_shifts``, of the first record of the pool, without an objective. Only of
    rolls that are wound: their radii begin elsewhere in every record, all others stay.

    Parameters
    ----------
    measured : (channels, samples) in channel units.
    first : index of the first judged sample.
    """
    twin = pool.twins[0]
    line, recorded = twin.declaration, recorded_angles(twin, measured)
    wound = {effective_radius_of(r.name) for r in line.rollers if r.kind == "roll"}
    known = wound & {n.name for n in declared_nuisances(line)} & set(recorded)

    def too_fast(moved: Mapping[str, float]) -> dict[str, float]:
        run = pool.one(replace(case, shifts=tuple(sorted(moved.items())), quick=False))[0]
        simulated = recorded_angles(twin, run)
        errors = {k: _slope_error(simulated[k][first:], recorded[k][first:]) for k in known}
        return {name: error for name, error in errors.items() if error}

    moved = _moved_into_step(dict(case.shifts), too_fast) if known else dict(case.shifts)
    return tuple(sorted(moved.items()))


def recorded_angles(twin: Twin, channels: Array) -> dict[str, Array]:
    """Return the recorded angles (samples,), rad, by the names of the rollers' effective radii.

    Speeds in rad/s are integrated where no angle is recorded.
    """
    angles: dict[str, Array] = {}
    for name, values in zip(twin.channels, channels, strict=True):
        if name.endswith("_angle_rad"):
            angles[effective_radius_of(name.removesuffix("_angle_rad"))] = values
    for name, values in zip(twin.channels, channels, strict=True):
        if name.endswith("_speed_rad_s"):
            roller = effective_radius_of(name.removesuffix("_speed_rad_s"))
            angles.setdefault(roller, np.cumsum(values) * twin.declaration.sample_time_s)
    return angles


def _slope_errors(
    objective: Objective, runs: Sequence[Array], measured: Sequence[Mapping[str, Array]]
) -> dict[str, float]:
    """Return by what share each simulated roll turns too fast, mean of records; none in step.

    Rolls go by the names of their effective radii.
    """
    here = objective.linearisation
    known = {n.name for n in objective.nuisances}
    ahead: dict[str, list[float]] = {}
    for run, declared, quick, twin, recorded, noise in zip(
        runs,
        here.declared_tick,
        here.quick_tick,
        objective.pool.twins,
        measured,
        objective.whitening.noise,
        strict=True,
    ):
        simulated = recorded_angles(twin, run + declared - quick)
        for name in known & set(simulated):
            ahead.setdefault(name, []).append(
                _slope_error(simulated[name][noise.first :], recorded[name][noise.first :])
            )
    return {name: float(np.mean(row)) for name, row in ahead.items() if np.any(row)}


def _slope_error(simulated: Array, recorded: Array) -> float:
    """Return by what share a simulated angle grows faster; 0 within ``in_step_rad``."""
    slope = float(np.polyfit(recorded - recorded[0], simulated - simulated[0], 1)[0]) - 1.0
    return slope if not abs(slope) * float(np.ptp(recorded)) < FIT.in_step_rad else 0.0
