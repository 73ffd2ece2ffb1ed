"""Least squares with tolerances: how much an effect explains that declared tolerances cannot."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from sim_plant.base.arrays import Array


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Gain:
    """What a candidate explains.

    Attributes
    ----------
    drop : fall of the cost, chi-square with q degrees of freedom when the effect is absent.
    values : best parameters (q,), in units of the sensitivity columns.
    covariance : of the values (q, q).
    seen : share of the candidate's signal that tolerances cannot imitate, 0..1.
    """

    drop: float
    values: Array
    covariance: Array
    seen: float


class Projector:
    """Cost min over nuisances of |r - A x|^2 + x' L x, and what further columns save on it.

    ``A`` (samples, n) whitened nuisance columns, ``precision`` (n,) of their priors (0: free).
    """

    def __init__(self, nuisances: Array, precision: Array) -> None:
        self.nuisances = nuisances
        self.precision = precision
        scale = np.sqrt(np.einsum("ij,ij->j", nuisances, nuisances) + precision)
        self._scale = np.where(scale > 0.0, scale, 1.0)
        self._unit = nuisances / self._scale
        normal = self._unit.T @ self._unit + np.diag(precision / self._scale**2)
        normal += 1e-10 * np.eye(normal.shape[0])
        self._factor = cho_factor(normal)

    def estimate(self, residual: Array) -> Array:
        """Return the nuisance values (n,) that explain ``residual`` best."""
        found: Array = cho_solve(self._factor, self._unit.T @ residual) / self._scale
        return found

    def project(self, columns: Array) -> Array:
        """Return what tolerances cannot explain of columns (samples,) or (samples, q)."""
        cut: Array = columns - self._unit @ cho_solve(self._factor, self._unit.T @ columns)
        return cut

    def cost(self, residual: Array) -> float:
        """Return the least cost with nuisances alone."""
        return float(residual @ self.project(residual))

    def gain(self, residual: Array, columns: Array) -> Gain:
        """Return what ``columns`` (samples, q) with free size save on the cost."""
        cut = self.project(columns)
        inner = columns.T @ cut
        size = np.sqrt(np.maximum(np.diag(columns.T @ columns), 1e-300))
        scaled = inner / np.outer(size, size)
        solve = np.linalg.pinv(scaled, rcond=1e-9, hermitian=True)
        against = (cut.T @ residual) / size
        values = solve @ against
        return Gain(
            drop=float(against @ values),
            values=values / size,
            covariance=solve / np.outer(size, size),
            seen=float(np.min(np.diag(scaled))),
        )

    def without(self, indices: list[int]) -> Projector:
        """Return the projector with some nuisances taken out (an effect replaces them)."""
        if not indices:
            return self
        keep = np.setdiff1d(np.arange(self.precision.size), indices)
        return Projector(self.nuisances[:, keep], self.precision[keep])
