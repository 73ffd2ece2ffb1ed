"""How far numbers really move: with noise as it is, and with what a model has wrong in places."""

from __future__ import annotations

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.objective import Objective


def block_covariance(objective: Objective, columns: Array, residual: Array) -> Array:
    """Return the covariance of numbers, told by how their estimates differ from block to block.

    ``columns`` (rows, q) are what the numbers change, ``residual`` (rows,) what is left. Where
    that is white noise this is the covariance of noise and tolerances, to the square root of two
    over the number of blocks. A model that is off at one plateau of speed, or after one step of
    tension, leaves there what pulls a number, and elsewhere what pulls it back.

    Equation: H^-1 (sum over blocks of g g' + Q' Q) H^-1 with H = Z' Z, Z what nuisances cannot
    explain of the columns, g = Z' r within a block, Q the rows of Z that stand for tolerances
    [White 1980, Liang and Zeger 1986].
    """
    own = objective.projector.project(columns)
    size = np.sqrt(np.maximum(np.einsum("ij,ij->j", own, own), 1e-300))
    unit = own / size
    left = objective.projector.project(residual)
    pulls = blocks(objective, unit * left[:, np.newaxis])
    tolerances = unit[objective.rows :]
    middle = pulls.T @ pulls + tolerances.T @ tolerances
    inverse = np.linalg.pinv(unit.T @ unit, rcond=1e-9, hermitian=True)
    found: Array = inverse @ middle @ inverse / np.outer(size, size)
    return found


def realised_covariance(objective: Objective, columns: Array) -> Array:
    """Return the covariance of numbers, told by how noise of seeded runs of the line moves them.

    The weighing takes channels one by one. Noise of a drive moves them together, and where it
    meets a limit it is no longer what it was: both move numbers by more than it says.

    Equation: mean of d d' over the runs, d what each one's noise is taken for  [parametric
    bootstrap, one linear step].
    """
    runs, numbers = objective.whitening.realisations, columns.shape[1]
    nothing = np.zeros(len(objective.nuisances))
    moved = []
    for each in zip(*runs, strict=True):
        noise = np.concatenate([objective.whitening.vector(each), nothing])
        moved.append(objective.projector.joint_estimate(noise, columns)[-numbers:])
    found: Array = np.mean([np.outer(d, d) for d in moved], axis=0)
    return found


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
