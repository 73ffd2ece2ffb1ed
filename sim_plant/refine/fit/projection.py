"""Least squares with tolerances: how much an effect explains that declared tolerances cannot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from sim_plant.base.arrays import Array

RIDGE = 1e-10
"""Share of a column's power that is added to it: two equal columns can still be solved for."""
AT_ONCE = 64
"""Columns that are multiplied together: some 30 MB of a long record."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LinearFit:
    """What further columns explain by one linear step.

    Attributes
    ----------
    chi2_reduction : fall of the cost, chi-square of q degrees of freedom if there is no effect.
    values : best parameters (q,), in units of the sensitivity columns.
    covariance : of the values (q, q), tolerances of declared numbers included.
    distinct_share : smallest share of a column's power that nuisances cannot imitate, 0..1.
    """

    chi2_reduction: float
    values: Array
    covariance: Array
    distinct_share: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Inner:
    """Products of columns C (rows, q) and a residual r in what nuisances cannot explain, P.

    Attributes
    ----------
    gram : C' P C (q, q).
    against : C' P r (q,).
    power : |c|^2 of every column (q,), before anything is taken out.
    """

    gram: Array
    against: Array
    power: Array

    def of(self, use: Sequence[int]) -> Inner:
        """Return the products of some of the columns."""
        at = list(use)
        return Inner(
            gram=self.gram[np.ix_(at, at)], against=self.against[at], power=self.power[at]
        )

    def fit(self) -> LinearFit:
        """Return what the columns, of free size, save on the cost."""
        size = np.sqrt(np.maximum(self.power, 1e-300))
        scaled = self.gram / np.outer(size, size)
        solve = np.linalg.pinv(scaled, rcond=1e-9, hermitian=True)
        against = self.against / size
        values = solve @ against
        return LinearFit(
            chi2_reduction=float(against @ values),
            values=values / size,
            covariance=solve / np.outer(size, size),
            distinct_share=float(np.min(np.diag(scaled))),
        )


class Projector:
    """Cost min over x of |r - A x|^2, and what further columns save on it.

    Priors are rows: ``A`` (rows, n) ends in one row per nuisance with a tolerance, see
    ``Objective``. Rows of candidate columns are zero there. A column whose size has a known
    variance but no such row has a ``precision`` (n,) instead, one over that variance; others 0.
    No vector of the length of a record is made for one number:
    r' P r = r' r - (A' r)' (A' A)^-1 (A' r), and so for columns.
    """

    def __init__(self, nuisances: Array, precision: Array | float = 0.0) -> None:
        self.nuisances = nuisances
        scale = np.sqrt(np.einsum("ij,ij->j", nuisances, nuisances))
        self._scale = np.where(scale > 0.0, scale, 1.0)
        self._unit = nuisances / self._scale
        known = np.broadcast_to(precision, self._scale.shape) / np.square(self._scale)
        self._normal = self._unit.T @ self._unit + np.diag(RIDGE + known)
        self._factor = cho_factor(self._normal)
        self._sizes: dict[int, Array] = {}

    def sizes(self, rows: int) -> Array:
        """Return the norm (n,) of every nuisance's first ``rows``; computed once per ``rows``."""
        if rows not in self._sizes:
            judged = self.nuisances[:rows]
            self._sizes[rows] = np.sqrt(np.einsum("ij,ij->j", judged, judged))
        return self._sizes[rows]

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
        along = self._unit.T @ residual
        return float(residual @ residual - along @ cho_solve(self._factor, along))

    def inner(self, residual: Array, columns: Array) -> Inner:
        """Return the products of ``columns`` (rows, q), see ``Inner``."""
        return self.inners(residual, [columns])[0]

    def inners(self, residual: Array, groups: Sequence[Array]) -> list[Inner]:
        """Return the products of every group of columns (rows, q), many at a time."""
        left = cho_solve(self._factor, self._unit.T @ residual)
        products: list[Inner] = []
        for some in _bundles(groups):
            every = np.concatenate(some, axis=1)
            along = self._unit.T @ every
            taken = cho_solve(self._factor, along, check_finite=False)
            against = every.T @ residual - along.T @ left
            at = 0
            for columns in some:
                here = slice(at, at + columns.shape[1])
                plain = columns.T @ columns
                products.append(
                    Inner(
                        gram=plain - along[:, here].T @ taken[:, here],
                        against=against[here],
                        power=np.diag(plain).copy(),
                    )
                )
                at = here.stop
        return products

    def linear_fit(self, residual: Array, columns: Array) -> LinearFit:
        """Return what ``columns`` (rows, q) of free size save on the cost."""
        return self.inner(residual, columns).fit()

    def explained(self, residual: Array, columns: Array) -> Array:
        """Return what each of ``columns`` (rows, q) alone saves on the cost (q,).

        0 for one of a run that broke down, or that nuisances imitate to 1e-9 of its power.
        """
        along = self._unit.T @ columns
        taken = cho_solve(self._factor, along, check_finite=False)
        power = np.einsum("ij,ij->j", columns, columns)
        own = power - np.einsum("ij,ij->j", along, taken)
        against = columns.T @ residual - taken.T @ (self._unit.T @ residual)
        sure = own > 1e-9 * power
        saved: Array = np.where(sure, against**2 / np.where(sure, own, 1.0), 0.0)
        return saved

    def joint_estimate(self, residual: Array, columns: Array) -> Array:
        """Return nuisances and sizes of ``columns`` (rows, q) that explain most together (n + q,).

        Equation: normal equations of [A C], each column at unit size, with the same ridge.
        """
        normal, scale = self._beside(columns)
        split = self._scale.size
        own = (columns.T @ residual) / scale[split:]
        scaled: Array = cho_solve(
            cho_factor(normal), np.concatenate([self._unit.T @ residual, own])
        )
        sizes: Array = scaled / scale
        return sizes

    def moved_by_held(self, columns: Array, at: Sequence[int], change: Array) -> Array:
        """Return by how much sizes of ``columns`` (q,) move when nuisances are held elsewhere.

        Those ``at`` are moved by ``change``, all others and the sizes are estimated again.
        Equation: -(N_ff)^-1 N_fh change, N the normal matrix of `joint_estimate`.
        """
        normal, scale = self._beside(columns)
        held = np.zeros(scale.size, dtype=bool)
        held[list(at)] = True
        push = normal[np.ix_(~held, held)] @ (change * scale[held])
        moved = np.zeros(scale.size)
        moved[~held] = -cho_solve(cho_factor(normal[np.ix_(~held, ~held)]), push)
        sizes: Array = (moved / scale)[self._scale.size :]
        return sizes

    def _beside(self, columns: Array) -> tuple[Array, Array]:
        """Return the normal matrix of nuisances and columns at unit norm, and their norms."""
        power = np.einsum("ij,ij->j", columns, columns)
        size = np.where(power > 0.0, np.sqrt(power), 1.0)
        beside = (self._unit.T @ columns) / size
        own = (columns.T @ columns) / np.outer(size, size) + RIDGE * np.eye(size.size)
        normal = np.block([[self._normal, beside], [beside.T, own]])
        return normal, np.concatenate([self._scale, size])

    def cost_with_fixed(self, residual: Array, fixed: Sequence[int]) -> float:
        """Return the least cost with all nuisances free but those ``fixed`` at 0."""
        free = np.delete(np.arange(self._normal.shape[0]), list(fixed))
        along = (self._unit.T @ residual)[free]
        taken = np.linalg.solve(self._normal[np.ix_(free, free)], along)
        return float(residual @ residual - along @ taken)


def _bundles(groups: Sequence[Array]) -> list[list[Array]]:
    """Return the groups in order, together as long as they have ``AT_ONCE`` columns at most."""
    bundles: list[list[Array]] = []
    count = AT_ONCE
    for columns in groups:
        if count + columns.shape[1] > AT_ONCE:
            bundles.append([])
            count = 0
        bundles[-1].append(columns)
        count += columns.shape[1]
    return bundles
