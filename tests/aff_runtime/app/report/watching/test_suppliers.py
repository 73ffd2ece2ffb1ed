"""Suppliers of rolls of web by rank, against what was put into the store."""

import json

import numpy as np
import pytest
from scipy import stats

from aff_runtime.app.report.parquet import table
from aff_runtime.app.report.watching import sentences
from aff_runtime.app.report.watching.store import Store
from aff_runtime.app.report.watching.suppliers import median_size, supplier_rankings
from aff_runtime.app.report.watching.tables import HOUR_FIELDS, ORDER_FIELDS
from aff_runtime.app.report.watching.wound_rolls import rankings
from tests.aff_runtime.app.report.watching.made_store import hour, order
from tests.each_case import each_case

FIRST_ROLL = 41
ROLLS = [(7, 3e-4), (7, 5e-4), (7, 4e-4), (9, 9e-4), (9, 1e-4), (0, 2e-3)]
"""Number of the supplier (0: the PLC gave none), and the roll's 1x, m; one a day."""


def store(rolls=ROLLS):
    """Rolls whose 2x is a half and 4x twice their 1x, and a first hour without the number."""
    orders = []
    for day, (supplier, size_m) in enumerate(rolls):
        for nth, share in ((1, 1.0), (2, 0.5), (4, 2.0)):
            mine = {
                "roll": "unwind",
                "order": nth,
                "is_roll": True,
                "roll_id": FIRST_ROLL + day,
                "shape_m": share * size_m,
                "shape_error_m": 1e-5,
            }
            orders += [order(day, **mine), order(day, **mine, supplier=supplier)]
    days = range(len(rolls))
    return Store(
        line="Euclid",
        hours=table(HOUR_FIELDS, [hour(day) for day in days]),
        orders=table(ORDER_FIELDS, orders),
    )


def ranked(of):
    return supplier_rankings(rankings(of))


def test_the_number_of_the_most_hours_is_the_supplier_of_a_roll():
    def of(*numbers):
        made = {"roll": "unwind", "is_roll": True, "roll_id": FIRST_ROLL, "shape_m": 1e-4}
        rows = [order(day, **made, supplier=number) for day, number in enumerate(numbers)]
        (place,) = rankings(
            Store(
                line="Euclid",
                hours=table(HOUR_FIELDS, [hour(day) for day in range(len(numbers))]),
                orders=table(ORDER_FIELDS, rows),
            )
        )
        return place.rolls[0].supplier

    assert of(*[3] * 9, 4) == 3
    assert of(8, *[3] * 2, 0, 0, 0) == 3
    assert (of(3, 4), of(4, 3), of(0, 0)) == (4, 3, 0)


def test_suppliers_are_ranked_by_the_median_of_their_rolls_in_the_first_three_orders():
    (place,) = ranked(store())
    assert (place.roll, place.by.name, place.unknown) == ("unwind", "shape_m", 1)
    first, second = place.suppliers
    assert (first.number, first.rolls, second.number, second.rolls) == (9, 2, 7, 3)
    assert [(m.order, m.size) for m in second.medians] == [
        (1, pytest.approx(4e-4)),
        (2, pytest.approx(2e-4)),
    ]
    assert first.medians[0].size == pytest.approx(5e-4)
    assert (first.worst_roll, first.worst.order) == (FIRST_ROLL + 3, 1)
    assert first.worst.size == pytest.approx(9e-4)


def test_suppliers_are_told_with_count_median_and_worst_roll():
    head, first, second = sentences.suppliers(ranked(store()))
    assert head == (
        "suppliers of rolls at unwind, the farthest from round first, median of their shape "
        "(95 % interval); 1 roll without a number:"
    )
    assert first == (
        "  1. supplier 9: 2 rolls, 1x 500 um (fewer than 6 rolls); 2x 250 um (fewer than 6 "
        "rolls); worst roll 44, 900 um at 1x"
    )
    assert "supplier 7: 3 rolls, 1x 400 um" in second
    said = json.loads(sentences.as_json("Euclid", [], ranked(store())))["suppliers"]
    assert [(one["supplier"], one["rolls"], one["worst_roll"]) for one in said] == [
        (9, 2, 44),
        (7, 3, 42),
    ]


def test_a_record_without_a_suppliers_number_says_what_to_map():
    (said,) = sentences.suppliers(ranked(store([(0, size) for _, size in ROLLS])))
    assert said.startswith("rolls at unwind are not ranked by supplier")
    assert said.endswith("rolls.unwind.supplier")


@each_case("count", [5, 6, 8, 9, 25, 400])
def test_the_interval_of_a_median_is_that_of_the_sign_test(count):
    found = median_size(1, np.arange(1.0, count + 1.0))
    k = int(stats.binom.ppf(0.025, count, 0.5))  # fewer heads than this: 2.5 % at most
    k -= stats.binom.cdf(k - 1, count, 0.5) > 0.025
    if k < 1:
        assert np.isnan([found.low, found.high]).all()
        return
    assert (found.low, found.high) == (k, count + 1 - k)
    assert found.size == pytest.approx((count + 1) / 2)
