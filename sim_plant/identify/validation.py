"""How far a model is from a record: norms of the error and the model-distortion test (2.2.2)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array

Simulate = Callable[[Array], Array]
"""Relative drifts (segments, parameters), 0 nominal -> simulated record (samples,)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Norms:
    """L1 and L2 as integrals over time and L-infinity, as section 2.2.2 defines them.

    Units: l1 signal * s, l2 signal^2 * s (the source's L2 is the integral of the square),
    linf signal.
    """

    l1: float
    l2: float
    linf: float


def norms(measured: Array, simulated: Array, sample_time_s: float) -> Norms:
    """Return the three norms of the error of a simulated record.

    Raises
    ------
    PlantError
        When the records differ in length or are empty.
    """
    if measured.shape != simulated.shape or measured.size == 0:
        raise PlantError(f"records of {measured.size} and {simulated.size} samples do not compare")
    error = np.abs(measured - simulated)
    return Norms(
        l1=float(np.sum(error)) * sample_time_s,
        l2=float(np.sum(error * error)) * sample_time_s,
        linf=float(np.max(error)),
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Distortion:
    """The smallest drift that makes a model follow a record.

    Attributes
    ----------
    drift : (segments, parameters), relative to the nominal values.
    rms_drift : (parameters,), and ``tolerance`` what the owner declares for them.
    misfit : rms of what is left over the noise; 1 is a perfect match.
    explained : whether any drift at all brings the misfit down to the noise.
    """

    drift: Array
    rms_drift: Array
    tolerance: Array
    misfit: float
    explained: bool

    @property
    def accepted(self) -> bool:
        """Whether the model passes: explained, and by drifts within the tolerances."""
        return self.explained and bool(np.all(self.rms_drift <= self.tolerance))


def model_distortion(
    measured: Array,
    simulate: Simulate,
    tolerance: Array,
    *,
    segments: int,
    noise_sd: float,
    steps: int = 6,
) -> Distortion:
    """Return the least tolerance-weighted drift with which ``simulate`` matches ``measured``.

    Section 2.2.2 (model distortion): any record can be followed by any model whose parameters
    drift; a good model needs less than their declared variance. Here parameters are constant on
    ``segments`` equal stretches; sum (drift / tolerance)^2 is least under the condition that the
    error is white at the size of the noise (rms error <= noise). Gauss-Newton on the model, and
    at each step the Lagrange multiplier of that condition by bisection.

    Raises
    ------
    PlantError
        When a tolerance or the noise is not positive.
    """
    if np.any(tolerance <= 0.0) or not noise_sd > 0.0:
        raise PlantError("model distortion needs positive tolerances and a positive noise")
    count = tolerance.size
    drift = np.zeros((segments, count))
    for _ in range(steps):
        base = simulate(drift)
        jacobian = _jacobian(simulate, drift, base) * np.tile(tolerance, segments)
        target = measured - base + jacobian @ (drift / tolerance).ravel()
        scaled = _least_norm(jacobian / noise_sd, target / noise_sd)
        change = scaled.reshape(segments, count) * tolerance - drift
        drift = drift + change
        if float(np.max(np.abs(change) / tolerance)) < 1e-3:
            break
    misfit = float(np.sqrt(np.mean((measured - simulate(drift)) ** 2))) / noise_sd
    return Distortion(
        drift=drift,
        rms_drift=np.sqrt(np.mean(drift**2, axis=0)),
        tolerance=tolerance,
        misfit=misfit,
        explained=misfit <= 1.1,
    )


def _jacobian(simulate: Simulate, drift: Array, base: Array) -> Array:
    columns = []
    for k in range(drift.size):
        moved = drift.ravel().copy()
        moved[k] += 1e-4
        columns.append((simulate(moved.reshape(drift.shape)) - base) / 1e-4)
    return np.column_stack(columns)


def _least_norm(matrix: Array, target: Array) -> Array:
    """Return the x of least norm with rms(target - matrix x) <= 1, or the best fit there is."""
    left, values, right = np.linalg.svd(matrix, full_matrices=False)
    inside = left.T @ target
    outside = float(target @ target - inside @ inside)

    def excess(weight: float) -> float:
        kept = weight / (values**2 + weight) * inside
        return (outside + float(kept @ kept)) / target.size - 1.0

    low, high = -30.0, 30.0
    if excess(np.exp(low)) > 0.0:
        weight = float(np.exp(low))
    else:
        for _ in range(80):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if excess(np.exp(middle)) <= 0.0 else (low, middle)
        weight = float(np.exp(low))
    solution: Array = right.T @ (values / (values**2 + weight) * inside)
    return solution
