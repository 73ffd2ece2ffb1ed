"""The names of an order's columns, taken apart."""

from __future__ import annotations

import pytest

from aff_runtime.base.order_columns import order_columns


@pytest.mark.parametrize(
    ("size", "law", "unit"),
    [
        ("shape_mm", "shape", "mm"),
        ("amplitude_m_s", "blocks", "m/s"),
        ("amplitude_N_m", "blocks", "N m"),
    ],
)
def test_an_order_is_told_with_family_and_unit_of_its_size(size: str, law: str, unit: str) -> None:
    parts = ("state", size, "phase_deg", "ripple")
    (one,) = order_columns(["tension_N", *(f"unwind.core_roll_12x.{part}" for part in parts)])
    assert (one.actuator, one.name, one.roll, one.order) == (
        "unwind",
        "core_roll_12x",
        "core_roll",
        12,
    )
    assert (one.law, one.size_unit, one.key) == (law, unit, "unwind.core_roll_12x")
    assert (one.state, one.size) == (f"{one.key}.state", f"{one.key}.{size}")
    assert (one.phase_deg, one.ripple) == (f"{one.key}.phase_deg", f"{one.key}.ripple")
    assert (one.ripple_before, one.response_ratio, one.share) == ("", "", "")


def test_a_torque_once_per_turn_belongs_to_no_roll() -> None:
    (one,) = order_columns(["unwind.imbalance.state", "unwind.imbalance.shape_mm"])
    assert (one.name, one.roll, one.order) == ("imbalance", "", 1)


def test_what_tells_no_state_is_no_order() -> None:
    assert order_columns(["unwind.unwind_1x.shape_mm", "unwind.correction", "probe.stage"]) == ()
