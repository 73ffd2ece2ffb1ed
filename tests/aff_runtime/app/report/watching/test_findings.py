"""Which readings and which limit a finding rests on: of the roller that turns now, in its unit."""

from __future__ import annotations

from dataclasses import replace
from datetime import timedelta

import numpy as np
import pytest

from aff_runtime.app.report.parquet import table
from aff_runtime.app.report.watching import sentences
from aff_runtime.app.report.watching.findings import FRICTION, findings
from aff_runtime.app.report.watching.store import Store
from aff_runtime.app.report.watching.tables import DRIVE_FIELDS, HOUR_FIELDS, ORDER_FIELDS
from aff_runtime.base.errors import ConfigError
from tests.aff_runtime.app.report.watching.made_store import (
    BEGAN,
    DAY,
    HOUR_M,
    LIMIT_M,
    SCATTER_M,
    drive,
    hour,
    made_store,
    order,
)

DAYS = 40
LAST = BEGAN + (DAYS - 1) * DAY


def at(moment):
    return moment.item()


def stroke_of(found):
    return [one for one in found if one.readings.quantity.name == "stroke_m"]


def exchanged(store: Store, days_after_the_last: int) -> Store:
    on = (LAST + days_after_the_last * DAY).item()
    store.exchange("r6", on, "worn")
    return store


def test_readings_before_an_exchange_count_no_longer_though_no_hour_is_newer():
    store = exchanged(made_store(DAYS), 1)
    now = LAST + 2 * DAY
    assert stroke_of(findings(store, now=at(now))) == []
    store.hours = table(HOUR_FIELDS, [hour(day) for day in range(DAYS + 2)])
    again = {"stroke_m": 1e-5, "stroke_error_m": SCATTER_M, "limit_m": LIMIT_M}
    rows = [order(day, stroke_m=4e-5, stroke_error_m=SCATTER_M) for day in range(DAYS)]
    store.orders = table(
        ORDER_FIELDS, [*rows, *(order(DAYS + k, life=2, **again) for k in (0, 1))]
    )
    (new,) = stroke_of(findings(store, now=at(now)))
    assert (new.readings.life, new.readings.size.tolist()) == (2, pytest.approx([1e-5, 1e-5]))


def test_until_the_day_of_an_exchange_the_present_roller_is_followed():
    store = exchanged(made_store(DAYS), 7)
    (old,) = stroke_of(findings(store, now=at(LAST + DAY)))
    assert (old.readings.life, old.readings.size.size) == (1, DAYS)
    assert old.stands_out
    assert stroke_of(findings(store, now=at(LAST + 8 * DAY))) == []


def test_a_clock_that_is_behind_the_readings_brings_no_former_life_back():
    store = exchanged(made_store(DAYS), -10)
    (found,) = stroke_of(findings(store, now=at(BEGAN)))
    assert (found.readings.life, found.readings.size.size) == (2, 11)


def test_an_exchange_is_of_one_roller():
    store = made_store(DAYS)
    other = table(ORDER_FIELDS, [order(0, roll="r7", stroke_m=4e-5, stroke_error_m=SCATTER_M)])
    store.orders = {
        name: np.concatenate([store.orders[name], other[name]]) for name in store.orders
    }
    store.exchange("r7", LAST.item() + timedelta(days=1), "")
    (found,) = stroke_of(findings(store, now=at(LAST + 2 * DAY)))
    assert found.readings.roll == "r6"


def both() -> Store:
    """Return a store in which a roller has a stroke, and a ripple while nothing went out."""
    rows = []
    for day in range(DAYS):
        rows.append(order(day, stroke_m=4e-5, stroke_error_m=SCATTER_M, limit_m=LIMIT_M))
        rows.append(order(day, ripple_N=1.0, ripple_error_N=0.01, correcting=False))
    return Store(
        line="E",
        hours=table(HOUR_FIELDS, [hour(d) for d in range(DAYS)]),
        orders=table(ORDER_FIELDS, rows),
    )


@pytest.mark.parametrize(
    ("limits", "stroke_m", "ripple_N"),
    [
        ({}, LIMIT_M, np.nan),
        ({("r6", "N"): 2.0}, LIMIT_M, 2.0),
        ({("r6", "m"): 2e-4}, 2e-4, np.nan),
        ({("r6", "m"): 2e-4, ("r6", "N"): 2.0}, 2e-4, 2.0),
    ],
)
def test_a_limit_holds_for_what_has_its_unit_and_leaves_the_others_alone(
    limits, stroke_m, ripple_N
):
    by = {one.readings.quantity.name: one.readings.limit for one in findings(both(), limits)}
    assert (by["stroke_m"], by["ripple_N"]) == pytest.approx((stroke_m, ripple_N), nan_ok=True)


def test_a_limit_of_a_roller_that_the_store_does_not_know_is_refused_with_those_it_knows():
    with pytest.raises(ConfigError, match="R6: the store knows no such roller; it knows r6"):
        findings(both(), {("R6", "m"): 2e-4})
    with pytest.raises(ConfigError, match="unwind: is a roll of web"):
        findings(made_store(), {("unwind", "m"): 2e-4})
    assert findings(Store(), {("R6", "m"): 2e-4}) == []


def test_friction_is_followed_at_a_like_speed_of_the_roll_through_all_rolls_of_web():
    store = made_store(DAYS)
    off = 0.002 * np.random.default_rng(3).standard_normal(DAYS)
    store.drives = table(
        DRIVE_FIELDS,
        [
            drive(
                day,
                speed_rad_s=9.0 if day % 4 == 0 else 5.0,
                friction_N_m=(0.9 if day % 4 == 0 else 0.5) + 0.004 * day + off[day],
                friction_error_N_m=0.002,
            )
            for day in range(DAYS)
        ],
    )
    found = next(one for one in findings(store) if one.readings.quantity is FRICTION)
    assert (found.readings.roll, found.readings.left_out) == ("unwind", DAYS // 4)
    per_km = 0.004 / (1e-3 * HOUR_M)
    assert found.per_km.low <= per_km <= found.per_km.high
    assert found.per_km.value == pytest.approx(per_km, rel=0.05)
    assert found.stands_out
    (said,) = (one for one in sentences.notes([found]))
    assert said.startswith("unwind friction grows: 1.1")
    assert "N m per 1000 km" in said


@pytest.mark.parametrize("speed_rad_s", [-5.0, 4e-4, -4e-4, 0.0])
def test_a_drive_that_turns_backwards_or_hardly_has_its_trend(speed_rad_s):
    store = made_store(DAYS)
    rows = [
        drive(day, friction_N_m=2.0, friction_error_N_m=0.1, speed_rad_s=speed_rad_s)
        for day in range(DAYS)
    ]
    store.drives = table(DRIVE_FIELDS, [*rows, replace(rows[-1], speed_rad_s=9.0)])
    (found,) = [one for one in findings(store) if one.readings.quantity == FRICTION]
    assert (found.readings.size.size, found.readings.left_out) == (DAYS, 1)


@pytest.mark.parametrize(("friction_N_m", "is_told"), [(-2.0, True), (-0.3, False), (2.0, False)])
def test_a_friction_below_0_tells_of_the_sign_of_the_torque(friction_N_m, is_told):
    for days in (1, DAYS):  # too few for a trend, and enough
        store = made_store(1)
        rows = [
            drive(day, friction_N_m=friction_N_m, friction_error_N_m=0.1) for day in range(days)
        ]
        store.drives = table(DRIVE_FIELDS, rows)
        (said,) = (one for one in sentences.table(findings(store)) if " friction " in one)
        assert said.endswith("; below 0: sign of torque") == is_told
        assert ("1 reading in 0 days" in said) == (days == 1)
        assert ("too few for a trend: it takes 8 readings and web" in said) == (days == 1)
