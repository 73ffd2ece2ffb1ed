"""How often a roller that does not change is told as one that does, and when growth is told.

Readings of six weeks, one a day, looked at every evening: ``python -m benchmarks.watch [DRAWS]``.
What a day is off, the next one keeps in part.
"""

from __future__ import annotations

import math
import sys

import numpy as np

from aff_runtime.app.report.watching.trend import FEWEST_READINGS, Array, jump, slope

DAYS = 42
GROWTH = 0.29
"""A day, as a share of the scatter between days."""
KEPT = (0.0, 0.3, 0.6, 0.8)


def draw(seed: int, kept: float) -> Array:
    """Return six weeks of readings about a size that stays."""
    rng = np.random.default_rng(seed)
    off = rng.standard_normal(DAYS)
    for day in range(1, DAYS):
        off[day] = kept * off[day - 1] + math.sqrt(1.0 - kept**2) * off[day]
    return np.asarray(40.0 + off, dtype=np.float64)


def first_days(size: Array) -> tuple[int | None, int | None]:
    """Return the first day that tells a trend, and the first that asks about a jump."""
    days, own = np.arange(float(DAYS)), np.full(DAYS, 0.1)
    trend = step = None
    for count in range(FEWEST_READINGS, DAYS + 1):
        known = days[:count], size[:count], own[:count]
        line = slope(*known)
        if trend is None and line is not None and line.stands_out:
            trend = count - 1
        if step is None and jump(*known) is not None:
            step = count - 1
    return trend, step


def main() -> int:
    """Print the shares and the days."""
    draws = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    for kept in KEPT:
        found = [first_days(draw(seed, kept)) for seed in range(draws)]
        trends, jumps = (sum(one[k] is not None for one in found) for k in (0, 1))
        print(f"a day keeps {kept:g}: {trends} trends and {jumps} jumps in {draws} draws of none")
    grown = [first_days(draw(seed, 0.0) + GROWTH * np.arange(DAYS))[0] for seed in range(draws)]
    told = [DAYS if day is None else day for day in grown]
    low, middle, high = np.percentile(told, (2.5, 50.0, 97.5))
    print(f"growth of {GROWTH:g} a day: told on day {middle:.0f} ({low:.0f} to {high:.0f})")
    return 0


if __name__ == "__main__":
    sys.exit(main())
