"""Inertia and friction of a driven roller without web, from torque and speed (2.27-2.33)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from sim_plant.base.arrays import Array
from sim_plant.identify.estimate import Estimate, UndecidableError, estimate
from sim_plant.identify.record import refuse_clipped

LOWEST_SPEED_RAD_S = 1.5
"""Below this the Coulomb term is no longer constant (its smooth sign reaches 1 to 1e-4)."""
_LEAST_SAMPLES = 50


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Run:
    """A record of one driven roller: even time grid, speed and the torque held after each row."""

    sample_time_s: float
    speed_rad_s: Array
    torque_N_m: Array


@dataclass(frozen=True, slots=True, kw_only=True)
class DrivenRoller:
    """What the records tell.

    Attributes
    ----------
    inertia_kg_m2, constant_N_m, viscous_N_m_s : J, c, b of J dw/dt = tau - c - b w (2.32).
    viscous_only_N_m_s : b of (2.31), which leaves c out; None without inertia or coast-down.
    residual_rad_s, viscous_only_residual_rad_s : rms of the coast-down fits (Fig. 2.5 b and a).
    nominal_inertia_kg_m2 : tau_n t_n / w_n (2.29), friction neglected as printed.
    """

    inertia_kg_m2: Estimate
    constant_N_m: Estimate
    viscous_N_m_s: Estimate
    viscous_only_N_m_s: float
    residual_rad_s: float
    viscous_only_residual_rad_s: float
    nominal_inertia_kg_m2: float


def fit_driven_roller(runs: Sequence[Run], inertia_kg_m2: float | None = None) -> DrivenRoller:
    """Return inertia and friction from run-ups and coast-downs.

    Output error: the speed is computed from the recorded torque, one free start speed a run, and
    J, c, b make the squared distance to the record least (2.33, with the run-up of 2.28 in the
    same sum). Run-up alone gives (tau - c)/J, coast-down alone c/J and b/J: only both together
    separate J. With ``inertia_kg_m2`` given the coast-down is enough.

    Raises
    ------
    UndecidableError
        No coast-down, no torque while J is asked for, a clipped speed, or too short a fall.
    """
    runs = [_usable(run) for run in runs]
    for run in runs:
        refuse_clipped("speed_rad_s", run.speed_rad_s)
    coasts = [coast for run in runs for coast in coast_downs(run)]
    _require_coast(coasts)
    if inertia_kg_m2 is None and not any(np.any(run.torque_N_m != 0.0) for run in runs):
        raise UndecidableError(
            "the torque is zero throughout, so only c/J and b/J show. Record a run-up at a "
            "known torque too, or give the inertia."
        )
    fit = _Fit(coasts if inertia_kg_m2 is not None else runs, inertia_kg_m2)
    found, covariance, freedom = fit.solve()
    errors = np.sqrt(np.diag(covariance))
    names = (
        ("inertia", "kg m2"),
        ("constant friction c", "N m"),
        ("viscous friction b", "N m s/rad"),
    )
    rows = [
        estimate(name, float(found[k]), float(errors[k]), freedom, unit)
        for k, (name, unit) in enumerate(names)
    ]
    inertia = float(found[0])
    b_only, viscous_rms = viscous_only(coasts, inertia)
    return DrivenRoller(
        inertia_kg_m2=rows[0],
        constant_N_m=rows[1],
        viscous_N_m_s=rows[2],
        viscous_only_N_m_s=b_only,
        residual_rad_s=_coast_rms(coasts, found),
        viscous_only_residual_rad_s=viscous_rms,
        nominal_inertia_kg_m2=_nominal(runs),
    )


def coast_downs(run: Run) -> list[Run]:
    """Return the parts without torque in which the speed falls.

    Without torque: below 1 % of the largest, so that a noisy torque signal has parts too.
    """
    size = np.abs(run.torque_N_m)
    quiet = size <= 0.01 * float(np.max(size))
    free = np.concatenate(([0], quiet.astype(np.int64), [0]))
    steps = np.diff(free)
    found = []
    for start, stop in zip(np.flatnonzero(steps == 1), np.flatnonzero(steps == -1), strict=True):
        speed = run.speed_rad_s[start:stop]
        if stop - start >= _LEAST_SAMPLES and speed[-1] < speed[0]:
            found.append(
                Run(
                    sample_time_s=run.sample_time_s,
                    speed_rad_s=speed,
                    torque_N_m=run.torque_N_m[start:stop],
                )
            )
    return found


def response(run: Run, inertia: float, constant: float, viscous: float, start: float) -> Array:
    """Return the speed (samples,) that J dw/dt = tau - c - b w gives for a run, exactly.

    Torque held over each sample: w' = a w + (1 - a)/b (tau - c), a = exp(-b dt / J)  [source
    2.30, 2.33 before the roller stops].
    """
    decay = viscous * run.sample_time_s / inertia
    a = np.exp(-decay)
    share = run.sample_time_s / inertia * (-np.expm1(-decay) / decay if decay != 0.0 else 1.0)
    push = share * (run.torque_N_m[:-1] - constant)
    tail, _ = lfilter([1.0], [1.0, -a], push, zi=[a * start])
    return np.concatenate(([start], tail))


class _Fit:
    """Gauss-Newton on J, c, b and one start speed a run."""

    def __init__(self, runs: Sequence[Run], inertia: float | None) -> None:
        self._runs = runs
        self._fixed = inertia
        self._measured = np.concatenate([run.speed_rad_s for run in runs])
        self._first = 3 if inertia is None else 2

    def _model(self, x: Array) -> Array:
        core = x[: self._first]
        inertia, constant, viscous = core if self._fixed is None else (self._fixed, *core)
        return np.concatenate(
            [
                response(run, inertia, constant, viscous, start)
                for run, start in zip(self._runs, x[self._first :], strict=True)
            ]
        )

    def _start(self) -> Array:
        """Return a first guess from the integral form, which is linear in J, c, b."""
        rows, right = [], []
        for run in self._runs:
            dt, speed = run.sample_time_s, run.speed_rad_s
            time = dt * np.arange(speed.size)
            angle = dt * (np.cumsum(speed) - 0.5 * (speed + speed[0]))
            impulse = dt * np.concatenate(([0.0], np.cumsum(run.torque_N_m[:-1])))
            gain = speed - speed[0]
            if self._fixed is None:
                rows.append(np.column_stack((gain, time, angle)))
                right.append(impulse)
            else:
                rows.append(np.column_stack((time, angle)))
                right.append(impulse - self._fixed * gain)
        core = np.linalg.lstsq(np.vstack(rows), np.concatenate(right), rcond=None)[0]
        return np.concatenate((core, [float(run.speed_rad_s[0]) for run in self._runs]))

    def solve(self) -> tuple[Array, Array, float]:
        """Return J, c, b, their covariance (3, 3) and the degrees of freedom."""
        x = self._start()
        for _ in range(8):
            model = self._model(x)
            steps = 1e-6 * np.maximum(np.abs(x), 1e-6)
            jacobian = np.column_stack(
                [
                    (self._model(x + d) - model) / s
                    for s, d in zip(steps, np.diag(steps), strict=True)
                ]
            )
            change = np.linalg.lstsq(jacobian, self._measured - model, rcond=None)[0]
            x = x + change
            if np.all(np.abs(change) <= 1e-9 * np.maximum(np.abs(x), 1e-9)):
                break
        residual = self._measured - self._model(x)
        freedom = float(residual.size - x.size)
        spread = float(residual @ residual) / freedom
        core = spread * np.linalg.inv(jacobian.T @ jacobian)[: self._first, : self._first]
        if self._fixed is None:
            return x[:3], core, freedom
        covariance = np.zeros((3, 3))
        covariance[1:, 1:] = core
        return np.array([self._fixed, x[0], x[1]]), covariance, freedom


def viscous_only(coasts: Sequence[Run], inertia_kg_m2: float) -> tuple[float, float]:
    """Return b of (2.31), w = w_0 exp(-b t / J), and the rms of the fit over all coast-downs."""
    viscous = 0.0
    starts = np.array([float(run.speed_rad_s[0]) for run in coasts])
    measured = np.concatenate([run.speed_rad_s for run in coasts])
    x = np.concatenate(([viscous], starts))
    for _ in range(20):
        model = _exponentials(coasts, inertia_kg_m2, x)
        steps = 1e-6 * np.maximum(np.abs(x), 1e-3)
        jacobian = np.column_stack(
            [
                (_exponentials(coasts, inertia_kg_m2, x + d) - model) / s
                for s, d in zip(steps, np.diag(steps), strict=True)
            ]
        )
        x = x + np.linalg.lstsq(jacobian, measured - model, rcond=None)[0]
    residual = measured - _exponentials(coasts, inertia_kg_m2, x)
    return float(x[0]), float(np.sqrt(np.mean(residual**2)))


def _exponentials(coasts: Sequence[Run], inertia: float, x: Array) -> Array:
    return np.concatenate(
        [response(run, inertia, 0.0, float(x[0]), s) for run, s in zip(coasts, x[1:], strict=True)]
    )


def _coast_rms(coasts: Sequence[Run], found: Array) -> float:
    """Return the rms of the coast-down fit with J, c, b, best start speeds."""
    inertia, constant, viscous = (float(value) for value in found)
    squares = count = 0.0
    for run in coasts:
        model = response(run, inertia, constant, viscous, float(run.speed_rad_s[0]))
        error = run.speed_rad_s - model
        error = error - error.mean()
        squares += float(error @ error)
        count += error.size
    return float(np.sqrt(squares / count))


def _usable(run: Run) -> Run:
    """Return the run up to where it first falls to creeping speed after having been faster."""
    fast = run.speed_rad_s > LOWEST_SPEED_RAD_S
    if not np.any(fast):
        raise UndecidableError(
            f"the roller never turns faster than {LOWEST_SPEED_RAD_S} rad/s; run it up first"
        )
    start = int(np.argmax(fast))
    slow = np.flatnonzero(~fast[start:])
    stop = start + int(slow[0]) if slow.size else fast.size
    if stop - start < _LEAST_SAMPLES:
        raise UndecidableError(f"only {stop - start} samples of a turning roller; record longer")
    return Run(
        sample_time_s=run.sample_time_s,
        speed_rad_s=run.speed_rad_s[start:stop],
        torque_N_m=run.torque_N_m[start:stop],
    )


def _require_coast(coasts: Sequence[Run]) -> None:
    if not coasts:
        raise UndecidableError(
            "no coast-down: the torque is never zero while the speed falls, so friction cannot "
            "be told from inertia. Switch the drive off at speed and let the roller run out."
        )
    deepest = max(1.0 - float(c.speed_rad_s[-1]) / float(c.speed_rad_s[0]) for c in coasts)
    if deepest < 0.3:
        raise UndecidableError(
            f"the coast-down loses only {100.0 * deepest:.0f} % of its speed: c and b look alike. "
            "Let the roller run out to at least 70 % of its speed, better to rest."
        )


def _nominal(runs: Sequence[Run]) -> float:
    """Return tau_n t_n / w_n of the first powered part (2.29), NaN without one."""
    for run in runs:
        powered = run.torque_N_m > 0.0
        if np.any(powered):
            start = int(np.argmax(powered))
            resting = np.flatnonzero(~powered[start:])
            stop = start + int(resting[0]) if resting.size else powered.size - 1
            gained = float(run.speed_rad_s[stop] - run.speed_rad_s[start])
            time = (stop - start) * run.sample_time_s
            if gained > 0.0:
                return float(np.mean(run.torque_N_m[start:stop])) * time / gained
    return float("nan")
