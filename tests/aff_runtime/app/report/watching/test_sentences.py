"""A time until a limit is told in whole days below a week, else in whole weeks, one of one."""

from __future__ import annotations

import numpy as np

from aff_runtime.app.report.watching.findings import QUANTITIES, Finding, Readings
from aff_runtime.app.report.watching.sentences import notes
from aff_runtime.app.report.watching.trend import slope
from tests.each_case import each_case

DAYS = np.arange(30.0)


def _grows_until(weeks: tuple[float, float, float]) -> Finding:
    size = 1e-5 + 1e-6 * DAYS
    error = np.full(DAYS.size, 1e-7)
    readings = Readings(
        signal="tension",
        roll="R6",
        order=1,
        life=1,
        quantity=QUANTITIES[0],
        at_m_s=1.0,
        limit=1e-4,
        times=np.datetime64("2026-01-01", "us") + DAYS.astype(int) * np.timedelta64(1, "D"),
        days=DAYS,
        travelled_km=86.4 * DAYS,
        size=size,
        error=error,
        left_out=0,
    )
    line = slope(DAYS, size, error)
    return Finding(readings=readings, per_km=line, per_day=line, jump=None, weeks=weeks)


@each_case(
    ("weeks", "told"),
    [
        ((0.02, 0.01, 0.04), "in less than a day (0.1 to 0.3 days)"),
        ((0.15, 0.1, 0.2), "in about 1 day (0.7 to 1.4 days)"),
        ((0.5, 0.4, 0.6), "in about 4 days (2.8 to 4.2 days)"),
        ((1.2, 0.9, 1.4), "in about 1 week (0.9 to 1.4 weeks)"),
        ((3.1, 2.0, float("inf")), "in about 3 weeks (2.0 weeks at least)"),
        ((600.0, 500.0, 700.0), "in more than 10 years"),
    ],
)
def test_the_time_until_a_limit_is_told_as_one_counts_it(weeks, told):
    (said,) = notes([_grows_until(weeks)])
    assert said.endswith(f"reaches 100 um {told}")
