"""What the overview shows of the last ten minutes: ripple as a line, tension as a band."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from aff_hmi.layout import Layout
from aff_hmi.see.series import MEASURED, NOW, VALUE, Series
from aff_hmi.see.trend_rows import LARGEST, LEAST, MEAN, coarser
from aff_hmi.see.trends import Trends
from aff_runtime.base.numbers import finite_or_none

WINDOW_S, BIN_S = 600, 10
FEWEST_S = 60  # seconds with data that a band needs
LOW_PERCENT, HIGH_PERCENT = 1.0, 99.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Trace:
    """One number of the overview over the window: means, None where it was not known."""

    slot: str
    means: tuple[float | None, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Band:
    """Where one number of the overview usually is.

    Attributes
    ----------
    low, high : 99 of 100 seconds had no tick below ``low``, 99 of 100 none above ``high``.
    """

    slot: str
    low: float
    high: float


@dataclass(frozen=True, slots=True, kw_only=True)
class RecentPart:
    """The last ten minutes; ``to_s`` : wall time up to which they are told."""

    to_s: float
    bin_s: int
    lines: tuple[Trace, ...]
    bands: tuple[Band, ...]


def recent_part(trends: Trends, layout: Layout, now_s: float) -> RecentPart:
    """Return the last ten minutes of what the overview shows, from what is kept of them."""
    ends_s = math.ceil(now_s / BIN_S) * BIN_S
    return RecentPart(
        to_s=round(now_s, 1),
        bin_s=BIN_S,
        lines=tuple(_lines(trends, layout, ends_s)),
        bands=tuple(_bands(trends, layout)),
    )


def _lines(trends: Trends, layout: Layout, ends_s: int) -> Iterator[Trace]:
    wanted = {
        # with the correction as it is, beside WITHOUT, what it would be without
        f"now:{one.actuator}": Series("ripple", one.signal, NOW, one.signal_unit)
        for one in layout.outputs
    }
    wanted |= {
        f"rms:{one.channel}": Series("ripple", one.label, MEASURED, "N") for one in layout.tensions
    }
    kept = {slot: one for slot, one in wanted.items() if one in trends.series}
    found = coarser(trends.seconds(tuple(kept.values()), WINDOW_S), BIN_S)
    bin_index = (found.t_s - (ends_s - WINDOW_S)) // BIN_S
    for n, slot in enumerate(kept):
        means = np.full(WINDOW_S // BIN_S, np.nan)
        is_inside = (bin_index >= 0) & (bin_index < len(means))
        means[bin_index[is_inside]] = found.bins[is_inside, MEAN, n]
        yield Trace(slot=slot, means=tuple(finite_or_none(one, 4) for one in means))


def _bands(trends: Trends, layout: Layout) -> Iterator[Band]:
    wanted = {
        f"tension:{one.channel}": Series("tension", one.label, VALUE, "N")
        for one in layout.tensions
    }
    kept = {slot: one for slot, one in wanted.items() if one in trends.series}
    bins = trends.seconds(tuple(kept.values()), WINDOW_S).bins
    for n, slot in enumerate(kept):
        known = bins[np.isfinite(bins[:, MEAN, n])][:, :, n]
        if len(known) >= FEWEST_S:
            low = np.percentile(known[:, LEAST], LOW_PERCENT)
            high = np.percentile(known[:, LARGEST], HIGH_PERCENT)
            yield Band(slot=slot, low=float(f"{low:.5g}"), high=float(f"{high:.5g}"))
