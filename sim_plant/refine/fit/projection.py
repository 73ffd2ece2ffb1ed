"""Least squares with tolerances: how much an effect explains that declared tolerances cannot."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from sim_plant.base.arrays import Array


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LinearFit:
    """What further columns explain by one linear step.

    Attributes
    ----------
    chi2_reduction : fall of the cost, chi-square with q degrees of freedom when they are nothing.
    values : best parameters (q,), in units of the sensitivity columns.
    covariance : of the values (q, q), tolerances of declared numbers included.
    distinct_share : share of the weakest column that nuisances cannot imitate, 0..1.
    """

    chi2_reduction: float
    values: Array
    covariance: Array
    distinct_share: float


class Projector:
    """Cost min over x of |r - A x|^2, and what further columns save on it.

    Priors are rows: ``A`` (rows, n) ends in one row per nuisance with a tolerance, see
    ``Objective``. Rows of candidate columns are zero there.
    """

    def __init__(self, nuisances: Array) -> None:
        self.nuisances = nuisances
        scale = np.sqrt(np.einsum("ij,ij->j", nuisances, nuisances))
        self._scale = np.where(scale > 0.0, scale, 1.0)
        self._unit = nuisances / self._scale
        normal = self._unit.T @ self._unit + 1e-10 * np.eye(nuisances.shape[1])
        self._factor = cho_factor(normal)

    def estimate(self, residual: Array) -> Array:
        """Return the nuisance values (n,) that explain ``residual`` best."""
        found: Array = cho_solve(self._factor, self._unit.T @ residual) / self._scale
        return found

    def project(self, columns: Array) -> Array:
        """Return what nuisances cannot explain of columns (rows,) or (rows, q)."""
        cut: Array = columns - self._unit @ cho_solve(self._factor, self._unit.T @ columns)
        return cut

    def cost(self, residual: Array) -> float:
        """Return the least cost with nuisances alone; infinite for a run that broke down."""
        if not np.isfinite(residual).all():
            return float("inf")
        return float(residual @ self.project(residual))

    def linear_fit(self, residual: Array, columns: Array) -> LinearFit:
        """Return what ``columns`` (rows, q) of free size save on the cost."""
        cut = self.project(columns)
        size = np.sqrt(np.maximum(np.einsum("ij,ij->j", columns, columns), 1e-300))
        scaled = (columns.T @ cut) / np.outer(size, size)
        solve = np.linalg.pinv(scaled, rcond=1e-9, hermitian=True)
        against = (cut.T @ residual) / size
        values = solve @ against
        return LinearFit(
            chi2_reduction=float(against @ values),
            values=values / size,
            covariance=solve / np.outer(size, size),
            distinct_share=float(np.min(np.diag(scaled))),
        )

    def with_columns(self, columns: Array) -> Projector:
        """Return the projector with further free columns (rows, q)."""
        return Projector(np.column_stack([self.nuisances, columns]))
