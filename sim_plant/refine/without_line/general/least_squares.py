"""Least squares by blocks: weights, errors on blocks left out, spread of weights."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.without_line.general.effect import OutputRecord
from sim_plant.refine.without_line.general.model import Model, own_regressors, regressors

GENERAL = CRITERIA.without_line.general
RIDGE = 1e-9
"""Added to the diagonal, of a column's power: neighbouring lags of a smooth input are alike."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Moments:
    """Products of regressors and output, per block.

    Attributes
    ----------
    matrix : (blocks, columns, columns).
    against : (blocks, columns).
    power : of the output (blocks,).
    samples : (blocks,).
    """

    matrix: Array
    against: Array
    power: Array
    samples: Array

    def weights(self, without: int | None = None) -> Array:
        """Return the weights of all blocks, or of all but one."""
        matrix, against = self.matrix.sum(axis=0), self.against.sum(axis=0)
        if without is not None:
            matrix, against = matrix - self.matrix[without], against - self.against[without]
        scale = np.sqrt(np.maximum(np.diag(matrix), 1e-300))
        unit = matrix / np.outer(scale, scale) + RIDGE * np.eye(scale.size)
        found: Array = np.linalg.solve(unit, against / scale) / scale
        return found

    def squares(self, weights: Array) -> Array:
        """Return the squared error of every block (blocks,)."""
        found: Array = (
            self.power - 2.0 * self.against @ weights + (self.matrix @ weights) @ weights
        )
        return np.maximum(found, 0.0)

    @property
    def total(self) -> float:
        """The squared error where all blocks are fitted."""
        return float(self.squares(self.weights()).sum())

    def left_out(self) -> Array:
        """Return the squared error of every block with the weights of all others (blocks,)."""
        found = [self.squares(self.weights(b))[b] for b in range(self.power.size)]
        return np.array(found)

    def spread(self) -> Array:
        """Return the standard deviation of the weights (columns,): the jackknife over blocks.

        Equation: s^2 = (B - 1) / B sum (w_b - mean w)^2, right for noise of any colour that is
        shorter than a block  [Efron 1982, 3.7].
        """
        blocks = self.power.size
        each = np.stack([self.weights(b) for b in range(blocks)])
        found: Array = np.sqrt((blocks - 1) / blocks * np.sum((each - each.mean(0)) ** 2, axis=0))
        return found


def block_edges(samples: int, records: int) -> NDArray[np.int64]:
    """Return where the blocks of a record begin and end."""
    count = max(GENERAL.fewest_blocks, -(-GENERAL.blocks // records))
    return np.linspace(0, samples, count + 1).astype(np.int64)


def moments(parts: Sequence[Array], outputs: Sequence[Array]) -> Moments:
    """Return the moments of records with regressors (samples, columns) and outputs (samples,)."""
    matrix, against, power, size = [], [], [], []
    for a, y in zip(parts, outputs, strict=True):
        edges = block_edges(y.size, len(outputs))
        for low, high in itertools.pairwise(edges):
            part, out = a[low:high], y[low:high]
            matrix.append(part.T @ part)
            against.append(part.T @ out)
            power.append(float(out @ out))
            size.append(high - low)
    return Moments(
        matrix=np.stack(matrix),
        against=np.stack(against),
        power=np.array(power),
        samples=np.array(size, dtype=np.float64),
    )


def parts_of(model: Model, records: Sequence[OutputRecord]) -> list[Array]:
    """Return the regressors of every record, its own zero and drift among them."""
    parts = []
    for k, record in enumerate(records):
        a = regressors(model, record, model.shift_of(k))
        if model.own:
            mine = np.zeros((a.shape[0], 2 * len(records)))
            mine[:, 2 * k : 2 * k + 2] = own_regressors(record)
            a = np.hstack([a, mine])
        parts.append(a)
    return parts


def fit(model: Model, records: Sequence[OutputRecord]) -> Moments:
    """Return the moments of a model on records."""
    return moments(parts_of(model, records), [record.judged for record in records])


def with_slopes(model: Model, records: Sequence[OutputRecord]) -> Moments:
    """Return the moments with a further column per number: the slope of what is explained."""
    parts = parts_of(model, records)
    outputs = [record.judged for record in records]
    weights = moments(parts, outputs).weights()
    at, steps = model.numbers, model.steps()
    slopes: list[list[Array]] = [[] for _ in records]
    for k, step in enumerate(steps):
        moved = at.copy()
        moved[k] += step
        for r, a in enumerate(parts_of(model.with_numbers(moved), records)):
            slopes[r].append((a - parts[r]) @ weights / step)
    wide = [
        np.hstack([a, np.stack(mine, axis=1)]) if mine else a
        for a, mine in zip(parts, slopes, strict=True)
    ]
    return moments(wide, outputs)


def refined(model: Model, records: Sequence[OutputRecord]) -> tuple[Model, Moments]:
    """Return the model with its numbers fitted: Gauss-Newton, the weights free at every step."""
    now = fit(model, records)
    count = model.numbers.size
    if count == 0:
        return model, now
    for _ in range(GENERAL.fit_steps):
        step = with_slopes(model, records).weights()[-count:]
        before, better = now.total, False
        for halving in range(GENERAL.step_halvings):
            tried = model.with_numbers(model.numbers + step * 0.5**halving)
            there = fit(tried, records)
            if there.total < before:
                model, now, better = tried, there, True
                break
        if not better or before - now.total < GENERAL.least_gain_share * before:
            break
    return model, now
