"""The parts of a recorded window in which nothing changed: one speed, corrected or not."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from aff_runtime.app.report.comparison.turns import Array, Flags
from aff_runtime.app.report.comparison.window import any_correction
from aff_runtime.base.probe_columns import EXCITING, STAGE
from aff_runtime.base.runs.table import RunTable
from aff_runtime.base.signals import StateBits, Status

BIN_S = 1.0
SAME_SPEED = 0.01
"""Share of its speed by which a second of a part may differ from the first one.

The window of a comparison may have twice as much.
"""
SLOWEST_M_S = 0.02
WHOLLY = 0.98
"""Share of the rows of a second that carry a correction, or none."""
MOST_PARTS = 5
"""Parts of a window that are named, the longest."""
PAST_LAST_S = 1e-6
"""By how much a part ends behind its last row: less than a tick."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SteadyPart:
    """Whole seconds at one speed, corrected all along or not at all.

    Attributes
    ----------
    from_s, to_s : rows with from_s <= time_s < to_s.
    bins : how many seconds. ``speed_m_s`` : mean of its first one.
    """

    from_s: float
    to_s: float
    bins: int
    speed_m_s: float
    correcting: bool

    def __str__(self) -> str:
        """Return it as it is said of a window."""
        state = "on" if self.correcting else "off"
        return f"{self.from_s:.1f}..{self.to_s:.1f} ({self.speed_m_s:.3g} m/s, AFF {state})"


def steady_parts(table: RunTable, speed_name: str) -> list[SteadyPart]:
    """Return the parts in their order; left out are splices, the probe's excitation and limits."""
    speed = table.columns.get(speed_name)
    if speed is None or speed.size < 2:
        return []
    time_s = table.columns["time_s"]
    second = np.floor((time_s - time_s[0]) / BIN_S).astype(np.int64)
    starts = np.flatnonzero(np.diff(second, prepend=second[0] - 1))
    read = np.isfinite(speed)  # what lacks is no standstill; a second without a reading is one
    mean = _means(np.where(read, speed, 0.0), starts)
    mean /= np.maximum(_means(read.astype(np.float64), starts), np.finfo(float).tiny)
    corrected = _means(any_correction(table.columns).astype(np.float64), starts)
    good = (_means(_disturbed(table), starts) == 0.0) & (np.abs(mean) > SLOWEST_M_S)
    good &= (corrected >= WHOLLY) | (corrected <= 1.0 - WHOLLY)
    good[1:] &= np.diff(time_s[starts]) < 2.0 * BIN_S
    ends = np.append(starts[1:], time_s.size) - 1
    return [
        SteadyPart(
            from_s=float(time_s[starts[first]]),
            to_s=float(time_s[ends[last - 1]]) + PAST_LAST_S,
            bins=last - first,
            speed_m_s=float(mean[first]),
            correcting=bool(corrected[first] > 0.5),
        )
        for first, last in _alike(good, mean, corrected > 0.5)
    ]


def longest_parts(table: RunTable, speed_name: str) -> list[str]:
    """Return a sentence with the longest parts in their order; nothing where there is one."""
    parts = steady_parts(table, speed_name)
    longest = sorted(parts, key=lambda part: -part.bins)[:MOST_PARTS]
    named = ", ".join(map(str, sorted(longest, key=lambda part: part.from_s)))
    return [f"its longest parts at one speed and in one state: {named}"] if len(parts) > 1 else []


def _means(values: Array, starts: np.typing.NDArray[np.intp]) -> Array:
    sums: Array = np.add.reduceat(values, starts)
    return sums / np.diff(np.append(starts, values.size))


def _disturbed(table: RunTable) -> Array:
    """Return per row whether a splice, the probe or a limit is in it."""
    columns = table.columns
    nothing = np.zeros(columns["time_s"].shape)
    disturbed: Flags = nothing > 0.0
    words = (("status", Status.SPLICE_ACTIVE), ("state_bits", StateBits.SATURATED))
    for name, bit in words:
        word = np.clip(np.nan_to_num(columns.get(name, nothing)), 0.0, 2.0**32).astype(np.int64)
        disturbed |= (word & int(bit)) != 0
    disturbed |= columns.get(STAGE, nothing) == EXCITING
    return disturbed.astype(np.float64)


def _alike(good: Flags, speed: Array, corrected: Flags) -> list[tuple[int, int]]:
    """Return [first, last) of sequences of good seconds, alike in speed and output."""

    def alike(one: int, other: int) -> bool:
        allowed = SAME_SPEED * abs(speed[other])
        return bool(
            corrected[one] == corrected[other] and abs(speed[one] - speed[other]) <= allowed
        )

    found, first = [], 0
    for k in range(good.size + 1):
        if k < good.size and good[k] and (k == first or alike(k, first)):
            continue
        if k > first:
            found.append((first, k))
        first = k if k < good.size and good[k] else k + 1
    return found
