"""The longest stretch of a recorded window in which nothing changed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from aff_runtime.app.report.comparison.lacking import NUMBERS_SHARE
from aff_runtime.app.report.comparison.steady_parts import BIN_S, steady_parts
from aff_runtime.app.report.comparison.window import Window, any_correction, window_of
from aff_runtime.base.runs.site_in_force import in_force_within
from aff_runtime.base.runs.table import RunTable
from aff_runtime.base.runs.window import RunWindow

SHORTEST_S, LONGEST_S = 20.0, 120.0


def steady(table: RunTable, speed_name: str) -> Window | None:
    """Return the longest stretch at one speed, corrected all along or not at all; None without.

    Of a longer one its first ``LONGEST_S``. Left out are splices, the probe's excitation, what
    ran into a limit, and a stretch of which ``NUMBERS_SHARE`` or less shows readings. Its site
    file is the one in force at its end.
    """
    longest = max(steady_parts(table, speed_name), key=lambda part: part.bins, default=None)
    if longest is None or longest.bins * BIN_S < SHORTEST_S:
        return None
    to_s = min(longest.to_s, longest.from_s + LONGEST_S)
    found = window_of(_cut(table, longest.from_s, to_s))
    return found if float(np.mean(found.rows)) > NUMBERS_SHARE else None


def is_correcting(window: Window) -> bool:
    """Return whether corrections went out in a stretch."""
    return bool(np.mean(any_correction(window.table.columns)) > 0.5)


def _cut(table: RunTable, from_s: float, to_s: float) -> RunTable:
    time_s = table.columns["time_s"]
    keep = (time_s >= from_s) & (time_s < to_s)
    window = RunWindow(folder=table.window.folder, from_s=from_s, to_s=to_s)
    columns = {name: values[keep] for name, values in table.columns.items()}
    sites = in_force_within(table.sites, from_s, to_s)[-1:]
    text = sites[0].text if sites else table.site_text
    return replace(table, window=window, columns=columns, events=(), site_text=text, sites=sites)
