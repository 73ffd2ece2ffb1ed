"""Whether the segments of a run go together: by their cycle, and by the times of their rows."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

LONGEST_RUN_S = 1e9
"""No run lasts 30 years: a later time is no time of a row."""
LARGEST_NUMBER = 1e30
"""What is larger is no reading; the square of this is still finite."""
PERIODS = "periods_count"
"""Column: cycles since the row before, one where no tick was missed."""
FEWEST_OF_A_CYCLE = 20
SAME_CYCLE_SHARE = 0.1
"""A segment whose tick differs by more is of another run: a cycle is not changed in one."""


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
