"""The longest stretch of a recorded window in which nothing changed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from aff_runtime.app.report.comparison.lacking import NUMBERS_SHARE
from aff_runtime.app.report.comparison.turns import Array, Flags
from aff_runtime.app.report.comparison.window import Window, any_correction, window_of
from aff_runtime.base.probe_columns import EXCITING, STAGE
from aff_runtime.base.run_table import RunTable
from aff_runtime.base.run_window import RunWindow
from aff_runtime.base.signals import StateBits, Status
from aff_runtime.base.site_in_force import in_force_within

BIN_S = 1.0
SHORTEST_S, LONGEST_S = 20.0, 120.0
SAME_SPEED = 0.01
"""Share of its speed by which a second of a stretch may differ from the first one.

The window of a comparison may have twice as much.
"""
SLOWEST_M_S = 0.02
WHOLLY = 0.98
"""Share of the rows of a second that carry a correction, or none."""


def steady(table: RunTable, speed_name: str) -> Window | None:
    """Return the longest stretch at one speed, corrected all along or not at all; None without.

    Of a longer one its first ``LONGEST_S``. Left out are splices, the probe's excitation, what
    ran into a limit, and a stretch of which ``NUMBERS_SHARE`` or less shows readings. Its site
    file is the one in force at its end.
    """
    speed = table.columns.get(speed_name)
    if speed is None or speed.size < 2:
        return None
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
    first, last = _longest(good, mean, corrected > 0.5)
    if (last - first) * BIN_S < SHORTEST_S:
        return None
    from_s = float(time_s[starts[first]])
    end = starts[last] if last < starts.size else time_s.size
    past_last_s = float(time_s[end - 1]) + 1e-6  # less than a tick
    to_s = min(past_last_s, from_s + LONGEST_S)
    found = window_of(_cut(table, from_s, to_s))
    return found if float(np.mean(found.rows)) > NUMBERS_SHARE else None


def is_correcting(window: Window) -> bool:
    """Return whether corrections went out in a stretch."""
    return bool(np.mean(any_correction(window.table.columns)) > 0.5)


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


def _longest(good: Flags, speed: Array, corrected: Flags) -> tuple[int, int]:
    """Return [first, last) of the longest sequence of good seconds, alike in speed and output."""

    def alike(one: int, other: int) -> bool:
        allowed = SAME_SPEED * abs(speed[other])
        return bool(
            corrected[one] == corrected[other] and abs(speed[one] - speed[other]) <= allowed
        )

    best, first = (0, 0), 0
    for k in range(good.size + 1):
        if k < good.size and good[k] and (k == first or alike(k, first)):
            continue
        if k - first > best[1] - best[0]:
            best = (first, k)
        first = k if k < good.size and good[k] else k + 1
    return best


def _cut(table: RunTable, from_s: float, to_s: float) -> RunTable:
    time_s = table.columns["time_s"]
    keep = (time_s >= from_s) & (time_s < to_s)
    window = RunWindow(folder=table.window.folder, from_s=from_s, to_s=to_s)
    columns = {name: values[keep] for name, values in table.columns.items()}
    sites = in_force_within(table.sites, from_s, to_s)[-1:]
    text = sites[0].text if sites else table.site_text
    return replace(table, window=window, columns=columns, events=(), site_text=text, sites=sites)
