"""Readings of a window that are no numbers: a channel is left out for them, or bridged."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from aff_runtime.app.report.comparison.turns import Array
from aff_runtime.base.printable import printable
from aff_runtime.base.runs.holes import BRIDGED_SHARE, bridged_share
from aff_runtime.base.runs.table import few

NUMBERS_SHARE = 0.5
"""Share of a channel's readings that are numbers, above which it is used: of fewer a figure would
be of other times than the window's."""


def share_of_numbers(values: Array) -> float:
    """Return the share of readings (rows,) that are numbers."""
    return float(np.isfinite(values).mean())


def lacking_readings(time_s: Array, readings: Mapping[str, Array]) -> list[str]:
    """Return sentences about the channels of which many readings (rows,) are no numbers."""
    if not time_s.size:
        return []
    left_out = {
        name: 1.0 - share
        for name, values in readings.items()
        if (share := share_of_numbers(values)) <= NUMBERS_SHARE
    }
    said = few(
        [
            f"{printable(name, 80)}: {100.0 * share:.0f} % of its readings are no numbers: it is "
            "left out"
            for name, share in left_out.items()
        ]
    )
    used = {name: values for name, values in readings.items() if name not in left_out}
    return said + few([*_bridged(time_s, used)])


def _bridged(time_s: Array, readings: Mapping[str, Array]) -> Iterator[str]:
    for name, values in readings.items():
        share = bridged_share(time_s, values)
        if share > BRIDGED_SHARE:
            yield (
                f"{printable(name, 80)}: {100.0 * share:.0f} % of its readings are no numbers and "
                "bridged between their neighbours: its figures are of the others"
            )
