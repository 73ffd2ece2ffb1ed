"""A figure with its error and its limit, and what a step says of all its figures."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from aff_runtime.app.report.comparison.turns import BATCHES, student_t
from aff_runtime.base.confidence import TWO_SIDED_95

Array = NDArray[np.float64]
NAN = math.nan


class Verdict(StrEnum):
    """What a measurement says of its step."""

    PASS = "pass"
    FAIL = "fail"
    OPEN = "open"
    NOT_APPLICABLE = "not applicable"


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """One number.

    Attributes
    ----------
    name, unit : what it is.
    value : NaN where it could not be measured.
    low, high : 95 % interval, or what is known of the error; NaN where nothing is.
    limit : in words. ``good`` : whether it is kept; None: cannot be said, or has no limit.
    needed : whether the step stays open while this figure cannot be judged by its limit.
    """

    name: str
    value: float
    unit: str = ""
    low: float = NAN
    high: float = NAN
    limit: str = ""
    good: bool | None = None
    needed: bool = True

    @property
    def is_missing(self) -> bool:
        """Whether the step waits for it."""
        return self.needed and self.good is None and bool(self.limit)


@dataclass(frozen=True, slots=True, kw_only=True)
class Sample:
    """One measurement of several that a step needs: of a load, of a probe, of a trip.

    Attributes
    ----------
    kind : what it is of: load, probe, course, candidate or trip. ``of`` : which one.
    names, numbers : single numbers by name, SI.
    columns, rows : a table, such as the points of a response; (rows, columns).
    """

    kind: str
    of: str
    names: tuple[str, ...] = ()
    numbers: tuple[float, ...] = ()
    columns: tuple[str, ...] = ()
    rows: tuple[tuple[float, ...], ...] = ()

    def number(self, name: str) -> float:
        """Return one number, NaN where there is none of that name."""
        return dict(zip(self.names, self.numbers, strict=True)).get(name, NAN)


@dataclass(frozen=True, slots=True, kw_only=True)
class StepResult:
    """What a step has measured.

    Attributes
    ----------
    remarks : sentences for the reader. ``proposals`` : settings that follow; none is applied.
    samples : new ones, kept for the next measurement of the step.
    missing : what the step still waits for, in sentences.
    """

    figures: tuple[Figure, ...]
    remarks: tuple[str, ...] = ()
    proposals: tuple[str, ...] = ()
    samples: tuple[Sample, ...] = ()
    missing: tuple[str, ...] = ()

    @property
    def waits_for(self) -> tuple[str, ...]:
        """What the step still waits for; where no sentence says it, figures that are not there."""
        names = (one.name for one in self.figures if one.is_missing)
        return self.missing or tuple(f"no figure: {name}" for name in names)

    @property
    def verdict(self) -> Verdict:
        """Pass, fail, or open while something is missing."""
        if any(figure.good is False for figure in self.figures):
            return Verdict.FAIL
        if self.waits_for or not self.figures:
            return Verdict.OPEN
        return Verdict.PASS


def at_most(value: float, bound: float) -> bool | None:
    """Return whether a value keeps an upper bound; None where there is no value."""
    return value <= bound if math.isfinite(value) else None


def at_least(value: float, bound: float) -> bool | None:
    """Return whether a value keeps a lower bound; None where there is no value."""
    return value >= bound if math.isfinite(value) else None


def mean_and_half(values: Array) -> tuple[float, float]:
    """Return the mean of readings and half its 95 % interval.

    Neighbours are not independent: the interval comes from the means of ``BATCHES`` equal parts.
    """
    finite = values[np.isfinite(values)]
    if not finite.size:
        return NAN, NAN
    mean = float(finite.mean())
    count = min(BATCHES, finite.size // 2)
    if count < 2:
        return mean, NAN
    length = finite.size // count
    parts = finite[: count * length].reshape(count, length).mean(axis=1)
    return mean, student_t(count - 1) * float(np.std(parts, ddof=1)) / math.sqrt(count)


def quantile(values: Array, share: float) -> tuple[float, float, float]:
    """Return a quantile and its 95 % interval from the order of the values (binomial)."""
    ordered = np.sort(values[np.isfinite(values)])
    n = ordered.size
    if not n:
        return NAN, NAN, NAN
    middle = share * n
    half = TWO_SIDED_95 * math.sqrt(n * share * (1.0 - share))
    at = [min(n - 1, max(0, math.ceil(place) - 1)) for place in (middle, middle - half)]
    last = min(n - 1, max(0, math.ceil(middle + half)))
    return float(ordered[at[0]]), float(ordered[at[1]]), float(ordered[last])


def joined(first: Sequence[Figure], *others: Sequence[Figure]) -> tuple[Figure, ...]:
    """Return figures of several parts as one."""
    return tuple(figure for part in (first, *others) for figure in part)
