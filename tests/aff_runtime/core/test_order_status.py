"""What a law writes into the record comes back as the same orders."""

from __future__ import annotations

import math

import pytest

from aff_runtime.core.controller import Controller
from aff_runtime.core.monitor import OrderState
from aff_runtime.core.order_status import Column, column_names, column_values, order_statuses
from tests.aff_runtime.core.plants import ACTUATOR, site
from tests.aff_runtime.core.shape_site import Rig


def test_names_and_numbers_of_one_table_stand_in_the_same_order():
    columns = (
        Column("a", lambda numbers: numbers),
        Column("b", lambda numbers: [-x for x in numbers]),
    )
    names, values = column_names(["r_1x", "r_2x"], columns), column_values([1.0, 2.0], columns)
    assert dict(zip(names, values, strict=True)) == {
        "r_1x.a": 1.0,
        "r_1x.b": -1.0,
        "r_2x.a": 2.0,
        "r_2x.b": -2.0,
    }


def test_a_column_that_lacks_an_order_is_an_error_and_no_shifted_record():
    columns = (Column("a", lambda _: [1.0, 2.0]), Column("b", lambda _: [1.0]))
    with pytest.raises(ValueError, match="shorter"):
        column_values(None, columns)


def test_every_order_of_the_plain_law_comes_back_from_its_columns():
    law = Controller(site(ACTUATOR), {})
    orders = law.order_statuses()
    assert [(o.roll, o.order) for o in orders] == list(ACTUATOR.orders)
    assert {(o.actuator, o.law, o.size_unit) for o in orders} == {(ACTUATOR.name, "blocks", "m/s")}
    assert all(o.state is OrderState.IDLE for o in orders)


def test_every_order_of_a_shape_and_its_imbalance_come_back_from_the_columns():
    law = Rig().law
    law.weight[0] = 3e-4j
    record = {
        f"unwind.{n}": v for n, v in zip(law.telemetry_names(), law.telemetry(), strict=True)
    }
    orders = order_statuses(record)
    assert [o.name for o in orders] == law.basis.names
    assert [o.is_imbalance for o in orders] == [False, False, True]
    assert (orders[0].law, orders[0].size_unit) == ("shape", "mm")
    assert (orders[0].size, orders[0].phase_deg) == (pytest.approx(0.3), pytest.approx(90.0))
    assert (orders[0].share, orders[0].response_ratio) == (1.0, pytest.approx(1.0))


def test_a_number_that_is_no_state_is_none_and_other_columns_are_no_orders():
    record = {"unwind.r_1x.state": math.nan, "unwind.r_2x.state": 99.0, "a.b.c": 1.0, "state": 2.0}
    assert [(o.name, o.state) for o in order_statuses(record)] == [("r_1x", None), ("r_2x", None)]
