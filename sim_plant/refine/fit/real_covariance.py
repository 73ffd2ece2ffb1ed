"""How far numbers really move: with noise as it is, and with what a model has wrong in places."""

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
class RealCovariance:
    """What moves numbers, in two parts that know nothing of each other.

    Attributes
    ----------
    noise : as the weighing takes it (q, q).
    tolerances : of declared numbers (q, q).
    variance : of every number (q,) by noise as it really is, and what a model has wrong in places.
    freedom : degrees of freedom of ``variance`` (q,).
    """

    noise: Array
    tolerances: Array
    variance: Array
    freedom: Array


def real_covariance(objective: Objective, columns: Array, residual: Array) -> RealCovariance:
    """Return what moves numbers; ``columns`` (rows, q) are what they change, ``residual`` is left.

    Three estimates of one variance, and the largest would be high by chance alone. The weighing
    is exact where noise is what it takes it for, and knows the steps of words; the seeded runs
    (`moved_by_runs`) know noise that channels share and that a limit changes: the larger of the
    two counts. What pulls differently from block to block (`blocks`) is an error of the model
    where it is more than that noise does by chance.

    Equation: A = (Z'Z)^-1 Z' with Z what nuisances cannot explain of the columns, its rows those
    of records and of tolerances; A A' of either rows. Of blocks A_b r summed as squares
    [White 1980, Liang and Zeger 1986], significance by the quantile of F.
    """
    own = objective.projector.project(columns)
    size = np.sqrt(np.maximum(np.einsum("ij,ij->j", own, own), 1e-300))
    unit = own / size
    inverse = np.linalg.pinv(unit.T @ unit, rcond=1e-9, hermitian=True) / size[:, np.newaxis]
    data, prior = unit[: objective.rows], unit[objective.rows :]
    noise = inverse @ (data.T @ data) @ inverse.T
    variance = np.maximum(noise.diagonal(), 0.0)
    freedom = np.full(variance.size, math.inf)
    runs = moved_by_runs(objective, unit) @ inverse.T
    if len(runs) > 1:
        seeded = runs.var(axis=0, ddof=1)
        freedom = np.where(seeded > variance, len(runs) - 1.0, freedom)
        variance = np.maximum(variance, seeded)
    left = objective.projector.project(residual)
    pulls = blocks(objective, unit * left[:, np.newaxis]) @ inverse.T
    pulled, free = np.sum(pulls**2, axis=0), len(pulls) - 1.0
    if free > 0.0:
        chance = fdtri(free, np.minimum(freedom, MANY), CRITERIA.report.confidence)
        wrong = pulled > chance * variance
        freedom = np.where(wrong, free, freedom)
        variance = np.where(wrong, pulled, variance)
    return RealCovariance(
        noise=noise,
        tolerances=inverse @ (prior.T @ prior) @ inverse.T,
        variance=variance,
        freedom=freedom,
    )


def moved_by_declared(objective: Objective, residual: Array, columns: Array) -> Array:
    """Return how far numbers (q,) go when declared numbers far off are put back.

    A declared number that a fit has moved further than chance moves any of them may imitate what
    the model has wrong. Its tolerance then says nothing of how far it may have taken others along.
    ``residual`` is what a fit leaves, ``columns`` (rows, q) are what its numbers change. Effective
    radii are told by the angle and stay.
    Equation: |z| > z_n, P(|z| < z_n)^n = the stated confidence  [Sidak 1967].
    """
    z = -residual[objective.rows :]
    own = np.array([not is_effective_radius(n.name) for n in objective.nuisances], dtype=bool)
    if not own.any():
        return np.zeros(columns.shape[1])
    most = float(ndtri(0.5 + 0.5 * CRITERIA.report.confidence ** (1.0 / np.sum(own))))
    out = np.flatnonzero(own & (np.abs(z) > most))
    back = -(z * objective.prior_sd)[out]
    return objective.projector.moved_by_held(columns, out.tolist(), back)


def moved_by_runs(objective: Objective, unit: Array) -> Array:
    """Return Z' of the noise of every seeded run (runs, q).

    The weighing takes channels one by one. Noise of a drive moves them together, and where it
    meets a limit it is no longer what it was: both move numbers by more than it says. What all
    runs share is no noise: the steps of words, on bodies that all turn alike.
    """
    data = unit[: objective.rows]
    whitened = objective.whitening.vector
    runs = [whitened(each) @ data for each in zip(*objective.whitening.realisations, strict=True)]
    return np.array(runs).reshape(-1, unit.shape[1])


def blocks(objective: Objective, products: Array) -> Array:
    """Return the sums of ``products`` (rows, q) over all channels, one time after another."""
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
