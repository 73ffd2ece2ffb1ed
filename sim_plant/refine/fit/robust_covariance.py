"""Robust covariance of the fitted numbers: noise, tolerances, and errors that the model has."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import fdtri, ndtri

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.model.nuisances import is_effective_radius

MANY = 1e9
"""Degrees of freedom of what is known and not estimated, where a quantile needs a number."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RobustCovariance:
    """Covariance of the q fitted numbers, by what moves them; the parts are independent.

    Attributes
    ----------
    noise : by noise as the weighing assumes it (q, q).
    tolerances : by declared numbers within their tolerances (q, q).
    variance : takes the place of the diagonal of ``noise`` (q,): by noise as the simulations show
        it, and by errors of the model that differ from one block of time to the next.
    degrees_of_freedom : degrees of freedom of ``variance`` (q,).
    """

    noise: Array
    tolerances: Array
    variance: Array
    degrees_of_freedom: Array


def robust_covariance(objective: Objective, jacobian: Array, residual: Array) -> RobustCovariance:
    """Return the covariance of fitted numbers.

    ``jacobian`` (rows, q): what a unit of each number changes of the residual's rows;
    ``residual`` : what their fit leaves.

    Three estimates of one variance, and the largest would be high by chance alone. The weighing
    is exact where noise is what it assumes, and knows rounding by a sensor's coarse steps;
    simulations of noise alone (`moved_by_noise`) know noise that channels share and that a limit
    of a drive (its torque, its loop's output) changes: the larger of the two counts.
    What the residual pulls differently from one block of time to the next
    (`block_sums`) is an error of the model where it is more than noise does by chance.

    Equation: A = (Z'Z)^-1 Z' with Z what nuisances cannot explain of the jacobian. Its columns
    are those of data (A_d) and of tolerances (A_t): noise = A_d A_d', tolerances = A_t A_t'. Model
    error: the sum over blocks b of (A_b r)^2 [White 1980, Liang and Zeger 1986], where that is
    above the quantile of F.
    """
    unexplained = objective.projector.project(jacobian)
    norms = np.sqrt(np.maximum(np.einsum("ij,ij->j", unexplained, unexplained), 1e-300))
    normed = unexplained / norms
    inverse = np.linalg.pinv(normed.T @ normed, rcond=1e-9, hermitian=True) / norms[:, np.newaxis]
    data, prior = normed[: objective.rows], normed[objective.rows :]
    noise = inverse @ (data.T @ data) @ inverse.T
    variance = np.maximum(noise.diagonal(), 0.0)
    freedom = np.full(variance.size, math.inf)
    moved = moved_by_noise(objective, normed) @ inverse.T
    if len(moved) > 1:
        simulated = moved.var(axis=0, ddof=1)
        freedom = np.where(simulated > variance, len(moved) - 1.0, freedom)
        variance = np.maximum(variance, simulated)
    left = objective.projector.project(residual)
    pulls = block_sums(objective, normed * left[:, np.newaxis]) @ inverse.T
    pulled, freedom_of_blocks = np.sum(pulls**2, axis=0), len(pulls) - 1.0
    if freedom_of_blocks > 0.0:
        freedom_of_noise = np.minimum(freedom, MANY)
        by_chance = fdtri(freedom_of_blocks, freedom_of_noise, CRITERIA.report.confidence)
        is_model_error = pulled > by_chance * variance
        freedom = np.where(is_model_error, freedom_of_blocks, freedom)
        variance = np.where(is_model_error, pulled, variance)
    return RobustCovariance(
        noise=noise,
        tolerances=inverse @ (prior.T @ prior) @ inverse.T,
        variance=variance,
        degrees_of_freedom=freedom,
    )


def moved_by_declared(objective: Objective, residual: Array, jacobian: Array) -> Array:
    """Return how far numbers (q,) move when declared numbers far off go back to what was declared.

    A declared number that a fit has moved further than chance moves any of them may imitate what
    the model has wrong. Its tolerance then says nothing of how far it may have taken others along.
    Effective radii stay: angles fix them.

    ``residual`` is what a fit leaves, ``jacobian`` (rows, q) what a unit of each of its numbers
    changes of the residual's rows.

    Equation: |z| > z_n, P(|z| < z_n)^n = the stated confidence, n of the declared numbers that are
    looked at  [Sidak 1967].
    """
    z = -residual[objective.rows :]
    looked_at = np.array(
        [not is_effective_radius(n.name) for n in objective.nuisances], dtype=bool
    )
    if not looked_at.any():
        return np.zeros(jacobian.shape[1])
    most = float(ndtri(0.5 + 0.5 * CRITERIA.report.confidence ** (1.0 / np.sum(looked_at))))
    far_off = np.flatnonzero(looked_at & (np.abs(z) > most))
    back = -(z * objective.prior_sd)[far_off]
    return objective.projector.moved_by_held(jacobian, far_off.tolist(), back)


def moved_by_noise(objective: Objective, normed: Array) -> Array:
    """Return how noise moves numbers, in every simulation of noise alone (simulations, q).

    ``normed`` (rows, q): the Z of `robust_covariance`, each column at norm 1; of its rows those of
    data count.

    The weighing takes channels one by one. Noise of a drive moves them together, and where it
    meets a limit of the drive it is no longer what it was: both move numbers by more than the
    weighing says.
    Rounding by a sensor's coarse steps is alike in all simulations, and goes out with their mean.
    """
    data = normed[: objective.rows]
    whitened = objective.whitening.vector
    realisations = zip(*objective.whitening.realisations, strict=True)
    moved = [whitened(each) @ data for each in realisations]
    return np.array(moved).reshape(-1, normed.shape[1])


def block_sums(objective: Objective, products: Array) -> Array:
    """Return the sums of ``products`` (rows, q) over all channels, block by block of time."""
    sums, at = [], 0
    for twin, part in zip(objective.pool.twins, objective.split(products[:, 0]), strict=True):
        channels, samples = part.shape
        rows = products[at : at + channels * samples].reshape(channels, samples, -1)
        at += channels * samples
        each = round(CRITERIA.report.block_s / twin.declaration.sample_time_s)
        first = np.arange(0, max(samples - each // 2, 1), each)
        sums.append(np.add.reduceat(rows.sum(axis=0), first, axis=0))
    found: Array = np.concatenate(sums)
    return found
