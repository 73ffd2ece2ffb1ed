"""A size over weeks: its slope with interval, when it reaches a limit, and where it jumped.

Weighted least squares with two sources of error in the weights: that of each reading, and how far
readings of different days scatter beyond it. The variance of the latter is that with which the
weighted squares of the residuals add up to their degrees of freedom (Paule and Mandel).
Deviations of neighbouring days are correlated: readings then count for fewer.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aff_runtime.app.report.comparison.turns import student_t

Array = NDArray[np.float64]

FEWEST_READINGS = 8
"""Of fewer no slope is given."""
FEWEST_FREEDOM = 4
"""Degrees of freedom that a slope needs to stand out."""
MOST_CORRELATED = 0.95
"""Correlation of neighbours that is taken at most."""
SIGMA = 4.0
"""A slope stands out where chance makes it as rarely as a normal deviate of so many standard
deviations: by Student's t, with few readings it takes more standard errors."""
JUMP_SIGMA = 5.0
"""The same for a jump."""
FEWEST_ON_A_SIDE, FEWEST_FOR_A_JUMP = 4, 12
HALVINGS = 25  # of the interval in which the variance between readings is sought
TINY = 1e-30
SMALLEST_ERROR = 1e-6
"""Error of a reading, as a share of its size, at least."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Slope:
    """A straight line through readings.

    Attributes
    ----------
    value : size per unit of the abscissa; ``error``: its standard error.
    low, high : 95 % interval.
    middle : abscissa where level and slope are not correlated; ``level`` there, with its error.
    scatter : standard deviation between readings beyond their own errors.
    correlation : of neighbours' deviations from the line; the errors allow for it.
    readings : how many. ``freedom`` : how many they count for, less two.
    """

    value: float
    error: float
    low: float
    high: float
    middle: float
    level: float
    level_error: float
    scatter: float
    correlation: float
    readings: int
    freedom: int

    @property
    def stands_out(self) -> bool:
        """Return whether it is beyond what chance makes, see ``SIGMA``."""
        enough = self.freedom >= FEWEST_FREEDOM
        return enough and abs(self.value) > student_t(self.freedom, SIGMA) * self.error

    def at(self, place: float) -> float:
        """Return the size on the line."""
        return self.level + self.value * (place - self.middle)

    def reaches(self, limit: float) -> tuple[float, float, float]:
        """Return where the line meets ``limit``, with the 95 % interval of that place.

        The ends are where the band around the line meets it (Fieller); infinite where one never
        does.
        """
        value = self.middle + (limit - self.level) / self.value if self.value else math.inf
        factor = student_t(self.freedom)
        rise, error = limit - self.level, factor * self.error
        # rise^2 - 2 rise b u + b^2 u^2 = factor^2 (level_error^2 + error^2 u^2)
        a = self.value**2 - error**2
        if a <= 0.0:
            return value, -math.inf, math.inf
        c = rise**2 - (factor * self.level_error) ** 2
        root = math.sqrt(max(0.0, (rise * self.value) ** 2 - a * c))
        ends = ((rise * self.value - root) / a, (rise * self.value + root) / a)
        return value, self.middle + ends[0], self.middle + ends[1]


@dataclass(frozen=True, slots=True, kw_only=True)
class Jump:
    """A step between two readings that no growth explains, even one that quickens.

    Attributes
    ----------
    index : of the first reading after it. ``before``, ``after`` : sizes on the lines there.
    """

    index: int
    before: float
    after: float


def at_least_small(error: Array, size: Array) -> Array:
    """Return errors of readings, none of which is zero."""
    return np.maximum(error, SMALLEST_ERROR * np.abs(size) + TINY)


def slope(place: Array, size: Array, error: Array) -> Slope | None:
    """Return the line through readings at ``place``; None of too few, or all in one place."""
    if size.size < FEWEST_READINGS or not float(np.ptp(place)) > 0.0:
        return None
    own = at_least_small(error, size)
    design = np.stack([np.ones_like(place), place - place.mean()], axis=1)
    scatter2 = _scatter(design, size, own)
    weight = 1.0 / (own**2 + scatter2)
    middle = float(np.average(place, weights=weight))
    spread = float(np.sum(weight * (place - middle) ** 2))
    level = float(np.average(size, weights=weight))
    value = float(np.sum(weight * (place - middle) * (size - level))) / spread
    correlation = _correlation((size - level - value * (place - middle)) * np.sqrt(weight))
    inflation = math.sqrt((1.0 + correlation) / (1.0 - correlation))
    freedom = max(1, round(size.size / inflation**2) - 2)
    deviation = inflation / math.sqrt(spread)
    half = student_t(freedom) * deviation
    return Slope(
        value=value,
        error=deviation,
        low=value - half,
        high=value + half,
        middle=middle,
        level=level,
        level_error=inflation / math.sqrt(float(weight.sum())),
        scatter=math.sqrt(scatter2),
        correlation=correlation,
        readings=int(size.size),
        freedom=freedom,
    )


def _correlation(residual: Array) -> float:
    """Return the correlation of neighbours, 0 at least.

    A fitted line lowers it, in the mean by (2 + 4 r) / n; that is added again.
    """
    squares = float(np.sum(residual**2))
    if not squares > 0.0:
        return 0.0
    correlation = float(np.sum(residual[1:] * residual[:-1])) / squares
    correlation += (2.0 + 4.0 * max(0.0, correlation)) / residual.size
    return min(max(0.0, correlation), MOST_CORRELATED)


def jump(place: Array, size: Array, error: Array) -> Jump | None:
    """Return the clearest step in readings that are sorted by place, None without one."""
    count = size.size
    if count < FEWEST_FOR_A_JUMP:
        return None
    own = at_least_small(error, size)
    best: tuple[float, Jump] | None = None
    along = (place - place.mean()) / (float(np.std(place)) or 1.0)
    growth = [np.ones_like(along), along, along**2]
    for index in range(FEWEST_ON_A_SIDE, count - FEWEST_ON_A_SIDE + 1):
        later = (np.arange(count) >= index).astype(np.float64)
        design = np.stack([*growth, later], axis=1)
        scatter2 = _first_scatter(design, size, own)
        line = _fit(design, size, own, scatter2)
        ratio = abs(float(line.found[3])) / math.sqrt(float(line.covariance[3, 3]) or TINY)
        off = (size - design @ line.found) / np.sqrt(own**2 + scatter2)
        correlation = _correlation(off)
        ratio *= math.sqrt((1.0 - correlation) / (1.0 + correlation))
        if ratio > student_t(count - 4, JUMP_SIGMA) and (best is None or ratio > best[0]):
            before = float(design[index, :3] @ line.found[:3])
            best = ratio, Jump(index=index, before=before, after=before + float(line.found[3]))
    return best[1] if best else None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Fit:
    """Coefficients with their covariance, and the weighted squares of the residuals."""

    found: Array
    covariance: Array
    squares: float


def _fit(design: Array, size: Array, own: Array, scatter2: float) -> _Fit:
    weight = 1.0 / (own**2 + scatter2)
    covariance = np.asarray(np.linalg.pinv((design * weight[:, None]).T @ design), np.float64)
    found = covariance @ (design.T @ (weight * size))
    squares = float(np.sum(weight * (size - design @ found) ** 2))
    return _Fit(found=found, covariance=covariance, squares=squares)


def _scatter(design: Array, size: Array, own: Array) -> float:
    """Return the variance between readings beyond their own errors."""
    freedom = size.size - design.shape[1]
    if _fit(design, size, own, 0.0).squares <= freedom:
        return 0.0
    low, high = 0.0, float(np.var(size)) * size.size / freedom  # no line: all is scatter
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        too_small = _fit(design, size, own, middle).squares > freedom
        low, high = (middle, high) if too_small else (low, middle)
    return float(high)


def _first_scatter(design: Array, size: Array, own: Array) -> float:
    """Return the same from one step (DerSimonian and Laird): for the many places of a jump."""
    line = _fit(design, size, own, 0.0)
    weight = 1.0 / own**2
    inner = (design * weight[:, None] ** 2).T @ design
    spread = float(weight.sum() - np.trace(line.covariance @ inner))
    return max(0.0, float(line.squares - (size.size - design.shape[1])) / spread)
