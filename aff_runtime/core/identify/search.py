"""Least squares of a smooth residual: Levenberg's steps with Marquardt's scale."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
STEP = 1e-6
LONGEST = 1.0
ROUNDS, SHORTENED = 60, 12
DONE = 1e-3


@dataclass(frozen=True, slots=True, kw_only=True)
class Minimum:
    """Where the sum of squares is least, that sum, and the covariance there."""

    at: Floats
    cost: float
    covariance: Floats


def least_squares(residual: Callable[[Floats], Floats], start: Floats) -> Minimum:
    """Return the minimum next to ``start``; steps that make it worse or no number are shortened.

    Parameters
    ----------
    residual : of several places at once, (places, unknowns) to (places, residuals).
    """
    at, left = start.copy(), residual(start[None, :])[0]
    cost = float(left @ left)
    damping = 1e-2
    for _ in range(ROUNDS):
        slopes = _slopes(residual, at, left)
        curvature, gradient = slopes.T @ slopes, slopes.T @ left
        before = cost
        for _ in range(SHORTENED):
            scaled = curvature + damping * np.diag(np.diag(curvature))
            trial = at - np.clip(np.linalg.solve(scaled, gradient), -LONGEST, LONGEST)
            there = _tried(residual, trial)
            reached = float(there @ there)
            if reached < cost:
                at, left, cost = trial, there, reached
                damping = max(0.2 * damping, 1e-9)
                break
            damping *= 4.0
        if not before - cost > DONE:
            break
    slopes = _slopes(residual, at, left)
    return Minimum(
        at=at, cost=cost, covariance=np.asarray(np.linalg.inv(slopes.T @ slopes), dtype=np.float64)
    )


def _slopes(residual: Callable[[Floats], Floats], at: Floats, left: Floats) -> Floats:
    """Return d residual / d unknown, (residuals, unknowns)."""
    aside = at + STEP * np.eye(at.size)
    return np.asarray((residual(aside) - left).T / STEP)


def _tried(residual: Callable[[Floats], Floats], at: Floats) -> Floats:
    """Return the residual, infinite where there is none."""
    try:
        with np.errstate(all="ignore"):
            there = residual(at[None, :])[0]
    except np.linalg.LinAlgError:
        there = np.array([math.inf])
    return there if np.isfinite(there).all() else np.array([math.inf])
