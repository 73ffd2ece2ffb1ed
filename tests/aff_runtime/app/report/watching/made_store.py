"""A store of made-up hours: one a day, one roller that grows, rolls of web that come and go."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from aff_runtime.app.report.parquet import table
from aff_runtime.app.report.watching.store import Store
from aff_runtime.app.report.watching.tables import (
    HOUR_FIELDS,
    ORDER_FIELDS,
    DriveRow,
    HourRow,
    OrderRow,
)

BEGAN = np.datetime64("2026-01-05T06:00:00", "us")
DAY = np.timedelta64(86_400_000_000, "us")
HOUR_M, HOUR_S = 3600.0, 3600.0
RADIUS_M, GROWS_M_A_DAY, FIRST_M, SCATTER_M, LIMIT_M = 0.0381, 1e-6, 4e-5, 3e-7, 8e-5
ROLLS = {41: 2e-3, 42: 5e-3, 43: 1e-3}
"""Number of the PLC, and how far the roll's first order is from round, m."""


def hour(day: int, *, length_m: float = HOUR_M) -> HourRow:
    return HourRow(
        run_id=f"run-{day}",
        hour=0,
        time_utc=BEGAN + day * DAY,
        run=f"run-{day}",
        config_hash="",
        covered_s=HOUR_S,
        length_m=length_m,
        offset_m=0.5 * length_m,
        speed_m_s=1.0,
        correcting=True,
    )


def order(day: int, **more: object) -> OrderRow:
    made = OrderRow(
        run_id=f"run-{day}",
        hour=0,
        time_utc=BEGAN + day * DAY,
        signal="unwind_tension_N",
        roll="r6",
        order=1,
        is_roll=False,
        correcting=True,
        travelled_km=1e-3 * HOUR_M * (day + 0.5),
        speed_m_s=1.0,
        radius_m=RADIUS_M,
    )
    return replace(made, **more)  # type: ignore[arg-type]


def drive(day: int, **more: object) -> DriveRow:
    made = DriveRow(
        run_id=f"run-{day}",
        hour=0,
        time_utc=BEGAN + day * DAY,
        signal="unwind_torque_N_m",
        roll="unwind",
        is_roll=True,
        correcting=True,
        travelled_km=1e-3 * HOUR_M * (day + 0.5),
        speed_m_s=1.0,
        radius_m=0.2,
        speed_rad_s=5.0,
    )
    return replace(made, **more)  # type: ignore[arg-type]


def made_store(days: int = 30) -> Store:
    """Return a store of so many days: r6's stroke grows, three rolls ran ten days each."""
    off_m = SCATTER_M * np.random.default_rng(1).standard_normal(days)
    orders = []
    for day in range(days):
        stroke_m = FIRST_M + GROWS_M_A_DAY * day + off_m[day]
        orders.append(order(day, stroke_m=stroke_m, stroke_error_m=SCATTER_M, limit_m=LIMIT_M))
        number = list(ROLLS)[min(day // 10, len(ROLLS) - 1)]
        for nth, share in ((1, 1.0), (2, 0.25)):
            orders.append(
                order(
                    day,
                    roll="unwind",
                    order=nth,
                    is_roll=True,
                    roll_id=number,
                    radius_m=0.2,
                    shape_m=share * ROLLS[number],
                    shape_error_m=1e-5,
                    ripple_N=0.1 * nth,
                    ripple_error_N=0.01,
                )
            )
    return Store(
        line="Euclid",
        hours=table(HOUR_FIELDS, [hour(day) for day in range(days)]),
        orders=table(ORDER_FIELDS, orders),
    )
