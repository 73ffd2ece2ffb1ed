"""Whether the segments of a run go together: by their cycle, and by the times of their rows."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from aff_runtime.base.runs.holes import LONGEST_GAP_CYCLES, cycle_s_of

LONGEST_RUN_S = 1e9
"""No run lasts 30 years: a later time is no time of a row."""
LARGEST_NUMBER = 1e30
"""What is larger is no reading; the square of this is still finite."""
PERIODS = "periods_count"
"""Column: cycles since the row before, one where no tick was missed."""
FEWEST_OF_A_CYCLE = 20
SAME_CYCLE_SHARE = 0.1
"""A segment whose tick differs by more is of another run: a cycle is not changed in one."""
FEW_NAMES = 5
"""Segments that are named of many."""


def period_s(rows: NDArray[np.float64], periods: NDArray[np.float64] | None) -> float:
    """Return the time of a tick in a segment, s, missed ones counted; NaN of a few rows."""
    with np.errstate(invalid="ignore", over="ignore"):  # a file may hold anything
        gone_s = np.diff(rows[:, 0])
        count = np.ones_like(gone_s) if periods is None else periods[1:]
        usable = (
            (gone_s > 0.0) & (gone_s < LONGEST_RUN_S) & (count > 0.0) & (count < LARGEST_NUMBER)
        )
    if int(np.sum(usable)) < FEWEST_OF_A_CYCLE:
        return math.nan
    return float(np.median(gone_s[usable] / count[usable]))


def of_another_cycle(
    parts: Mapping[Path, NDArray[np.float64]], periods_s: Mapping[Path, float]
) -> list[tuple[Path, str]]:
    """Return the segments whose tick is of another length than that of most rows, with words."""
    known = [path for path in parts if math.isfinite(periods_s[path]) and parts[path].size]
    if len(known) < 2:
        return []
    rows_of_each = np.array([parts[path].shape[0] for path in known])
    lengths = np.array([periods_s[path] for path in known])
    order = np.argsort(lengths, kind="stable")
    half = np.searchsorted(np.cumsum(rows_of_each[order]), 0.5 * rows_of_each.sum())
    usual_s = float(lengths[order][half])
    return [
        (
            path,
            f"{path.name}: a tick takes {1e3 * periods_s[path]:.4g} ms in it, "
            f"{1e3 * usual_s:.4g} ms in the others: it is of another run; left out",
        )
        for path in known
        if abs(periods_s[path] / usual_s - 1.0) > SAME_CYCLE_SHARE
    ]


def odd_times(path: Path, time_s: NDArray[np.float64]) -> Iterator[str]:
    """Yield what is odd about the times of a segment: rows before 0 s are in no window."""
    early = int(np.sum(time_s < 0.0))
    if early:
        yield f"{path.name}: {early} rows are of a time before 0 s; left out"
    back = np.flatnonzero(time_s[1:] <= time_s[:-1])  # False where a time is NaN
    if back.size:
        at_s, to_s = (float(time_s[back[0] + k]) for k in (0, 1))
        yield f"{path.name}: its clock goes back, from {at_s:.2f} s to {to_s:.2f} s"


def rows_once(parts: Mapping[Path, NDArray[np.float64]]) -> tuple[NDArray[np.float64], list[str]]:
    """Return the rows of all segments (rows, columns), no time twice, and what is said of that.

    The clock of a run only rises: a segment that has times of one before it is a copy, or of
    another run. Those of the lower number are taken; segments that stand back are put in order.
    """
    said: list[str] = []
    taken: dict[Path, NDArray[np.float64]] = {}
    for path, its_rows in parts.items():
        rows = its_rows
        if not rows.size:
            continue
        low, high = rows[:, 0].min(), rows[:, 0].max()
        others = [
            one for one, its in taken.items() if its[:, 0].min() <= high and low <= its[:, 0].max()
        ]
        if others:
            again = _recorded_before([taken[one][:, 0] for one in others], rows[:, 0])
            said += _overlaps(path, rows[again, 0], rows.shape[0], others)
            rows = rows[~again]
        if rows.size:
            taken[path] = rows
    middles = {path: float(np.median(rows[:, 0])) for path, rows in taken.items()}
    said += [
        f"{path.name}: its rows are before those of {before.name}; put in the order of time"
        for before, path in itertools.pairwise(taken)
        if middles[path] < middles[before]
    ]
    order = sorted(taken, key=lambda path: middles[path])
    return np.vstack([taken[path] for path in order]), said


def _recorded_before(
    earlier_s: Sequence[NDArray[np.float64]], time_s: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Return per row whether its time is one of earlier rows, or between two without a hole."""
    seen = np.sort(np.concatenate(earlier_s))
    longest_s = LONGEST_GAP_CYCLES * cycle_s_of(seen)
    at = np.searchsorted(seen, time_s)
    after, before = seen[np.minimum(at, seen.size - 1)], seen[np.maximum(at - 1, 0)]
    again = (after == time_s) | ((before < time_s) & (time_s < after))
    again &= (after == time_s) | (after - before < longest_s)
    return again if int(again.sum()) > 1 else np.zeros_like(again)  # one: where they meet


def _overlaps(
    path: Path, again_s: NDArray[np.float64], count: int, others: Sequence[Path]
) -> Iterator[str]:
    """Yield a sentence on the rows of a segment whose times were recorded before."""
    if again_s.size:
        names = ", ".join(other.name for other in others[:FEW_NAMES])
        yield (
            f"{path.name}: {again_s.size} of its {count} rows ({again_s.min():.2f} to "
            f"{again_s.max():.2f} s) are of times that {names} has: a copy, or of another run; "
            "counted once, copy it anew from the gateway"
        )
