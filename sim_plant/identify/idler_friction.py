"""Bearing friction of idle rollers from two load cells at several line speeds (2.34-2.46)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.identify.estimate import Estimate, UndecidableError, block_standard_error, estimate
from sim_plant.identify.record import refuse_clipped

_LEAST_SPEEDS = 3
_LEAST_SPREAD = 0.3


@dataclass(frozen=True, slots=True, kw_only=True)
class Plateau:
    """One steady speed: roller speed, rad/s, and tension downstream minus upstream, N."""

    omega_rad_s: float
    tension_drop_N: float
    standard_error_N: float


@dataclass(frozen=True, slots=True, kw_only=True)
class IdlerFriction:
    """c and b of tau_f = c + b w for one roller, and the points behind them."""

    constant_N_m: Estimate
    viscous_N_m_s: Estimate
    divisor: float
    omega_rad_s: tuple[float, ...]
    torque_N_m: tuple[float, ...]


def rollers_between_cells(idlers_between: int) -> float:
    """Return how many bearings lie between two load-cell readings: 1/2 + idlers + 1/2.

    Each cell reads the mean of its two spans (2.35), so half of its own roller's friction lies
    on either side, as (2.39) has it for neighbours. Correction of (2.42)-(2.43): for R3 and R9
    with five idlers between them the divisor is 6; the printed 7 makes torques 14 % too small.
    """
    return idlers_between + 1.0


def plateaus(
    time_s: Array,
    speed_m_s: Array,
    downstream_N: Array,
    upstream_N: Array,
    radius_m: float,
    settle_s: float = 5.0,
) -> list[Plateau]:
    """Return the steady stretches of one record, each without its first ``settle_s``.

    Raises
    ------
    UndecidableError
        A tension is clipped, or no stretch is steady for long enough.
    """
    refuse_clipped("the downstream tension", downstream_N)
    refuse_clipped("the upstream tension", upstream_N)
    found = []
    for begin, stop in steady_stretches(time_s, speed_m_s):
        start = int(np.searchsorted(time_s, time_s[begin] + settle_s))
        if stop - start < 200:
            continue
        drop = downstream_N[start:stop] - upstream_N[start:stop]
        found.append(
            Plateau(
                omega_rad_s=float(np.mean(speed_m_s[start:stop])) / radius_m,
                tension_drop_N=float(np.mean(drop)),
                standard_error_N=block_standard_error(drop),
            )
        )
    if not found:
        raise UndecidableError(
            "the line speed is steady nowhere for long enough; hold each speed for half a minute"
        )
    return found


def steady_stretches(time_s: Array, speed_m_s: Array) -> list[tuple[int, int]]:
    """Return (start, stop) rows of stretches whose one-second means stay within 1 %."""
    rate = (time_s.size - 1) / float(time_s[-1] - time_s[0])
    block = max(1, round(rate))
    count = speed_m_s.size // block
    means = speed_m_s[: count * block].reshape(count, block).mean(axis=1)
    found: list[tuple[int, int]] = []
    start = 0
    for k in range(1, count + 1):
        level = float(np.mean(means[start:k]))
        if k == count or abs(means[k] - level) > 0.01 * abs(level) + 1e-4:
            if k - start >= 3:
                found.append((start * block, k * block))
            start = k
    return found


def fit_idler_friction(
    points: Sequence[Plateau], radius_m: float, divisor: float
) -> IdlerFriction:
    """Return c and b by weighted linear regression of tau_f = R (T_down - T_up) / divisor.

    Equation: (2.45) with tau_f = + c + b w. Corrections: drag raises the tension downstream, so
    (2.41) needs T_down - T_up, and (2.44) has the sign of neither. Neighbouring speeds count by
    their own standard errors; intervals use the errors and the scatter, whichever is larger.

    Raises
    ------
    UndecidableError
        Fewer than three speeds, or speeds too close together, or no drag at all.
    """
    omega = np.array([p.omega_rad_s for p in points])
    distinct = _distinct(omega)
    if distinct < _LEAST_SPEEDS:
        speeds = "one speed" if distinct == 1 else f"{distinct} speeds"
        raise UndecidableError(
            f"{speeds} only: constant and viscous friction cannot be told apart with an error. "
            f"Record at least {_LEAST_SPEEDS} line speeds."
        )
    spread, fastest = float(np.ptp(omega)), float(np.max(omega))
    if spread < _LEAST_SPREAD * fastest:
        raise UndecidableError(
            f"the speeds span only {spread:.3g} rad/s of {fastest:.3g}: "
            "viscous friction drowns. Spread them to at least 30 % of the fastest."
        )
    torque = radius_m / divisor * np.array([p.tension_drop_N for p in points])
    error = radius_m / divisor * np.array([p.standard_error_N for p in points])
    if np.all(torque <= 2.0 * error):
        raise UndecidableError(
            "the tension does not rise from the upstream to the downstream cell: the channels "
            "may be exchanged, or the idlers have no measurable friction"
        )
    weight = 1.0 / np.maximum(error, 1e-12)
    columns = np.column_stack((np.ones_like(omega), omega)) * weight[:, None]
    normal = np.linalg.inv(columns.T @ columns)
    found = normal @ (columns.T @ (torque * weight))
    scatter = float(np.sum((torque * weight - columns @ found) ** 2)) / (omega.size - 2)
    errors = np.sqrt(np.diag(normal) * max(scatter, 1.0))
    freedom = float(omega.size - 2) if scatter > 1.0 else 19.0 * omega.size
    return IdlerFriction(
        constant_N_m=estimate(
            "constant friction c", float(found[0]), float(errors[0]), freedom, "N m"
        ),
        viscous_N_m_s=estimate(
            "viscous friction b", float(found[1]), float(errors[1]), freedom, "N m s/rad"
        ),
        divisor=divisor,
        omega_rad_s=tuple(float(w) for w in omega),
        torque_N_m=tuple(float(t) for t in torque),
    )


def _distinct(omega: Array) -> int:
    """Return the number of speeds that differ by more than 2 % of the fastest."""
    ordered = np.sort(omega)
    return 1 + int(np.sum(np.diff(ordered) > 0.02 * ordered[-1]))
