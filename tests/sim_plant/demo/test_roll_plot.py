"""The roll in the demo's report: read from the runtime's record, drawn in mm."""

from __future__ import annotations

import numpy as np
import pytest

from sim_plant.demo.evaluation import more_orders
from sim_plant.demo.roll_plot import LearnedOrder, deviation_mm, learned_orders, roll_plot

TIME_S = np.arange(0.0, 20.0, 0.005)


def columns(orders: int) -> dict[str, np.ndarray]:
    found = {"time_s": TIME_S}
    for n in range(1, orders + 1):
        found[f"unwind.unwind_{n}x.state"] = np.ones(TIME_S.size)
        found[f"unwind.unwind_{n}x.shape_mm"] = np.linspace(0.0, 1.0 / n, TIME_S.size)
        found[f"unwind.unwind_{n}x.phase_deg"] = np.full(TIME_S.size, 10.0 * n)
    found["unwind.imbalance.state"] = np.ones(TIME_S.size)
    found["unwind.imbalance.shape_mm"] = np.zeros(TIME_S.size)
    return found


def test_the_last_row_of_every_order_is_what_was_learned() -> None:
    learned = learned_orders(columns(3))
    assert [(one.roll, one.order) for one in learned] == [("unwind", n) for n in (1, 2, 3)]
    assert learned[1].deviation_mm == pytest.approx(0.5)
    assert learned[1].angle_deg == 20.0


def test_the_plain_law_has_no_roll_to_show() -> None:
    plain = {"time_s": TIME_S, "unwind.unwind_1x.amplitude_m_s": TIME_S}
    plain["unwind.unwind_1x.state"] = np.ones(TIME_S.size)
    assert learned_orders(plain) == []
    assert roll_plot([]) == ""


def test_orders_add_up_to_the_arm_around_the_turn() -> None:
    def one(order: int, mm: float, deg: float) -> LearnedOrder:
        return LearnedOrder(actuator="u", roll="r", order=order, deviation_mm=mm, angle_deg=deg)

    angle = np.array([0.0, np.pi / 2, np.pi])
    # 2 cos(t + 90 deg) + cos(2 t): 1, -2 - 1, 1
    got = deviation_mm([one(1, 2.0, 90.0), one(2, 1.0, 0.0)], angle)
    assert got == pytest.approx([1.0, -3.0, 1.0])


def test_a_roll_with_several_orders_is_drawn_and_a_single_order_is_not() -> None:
    learned = learned_orders(columns(4))
    drawn = roll_plot(learned)
    assert drawn.startswith("<svg")
    assert "moment arm over the roll" in drawn or "<path" in drawn
    assert roll_plot(learned) == drawn  # the same data, the same bytes
    assert roll_plot(learned[:1]) == ""


def test_orders_above_those_with_a_target_are_judged_on_the_true_tension() -> None:
    def part(amplitude: float) -> dict[str, np.ndarray]:
        unwind, follower = 5.0 * TIME_S, 6.6 * TIME_S
        return {
            "time_s": TIME_S,
            "true_unwind_tension_N": 90.0 + amplitude * np.cos(6 * unwind + 0.3),
            "true_pullroll_tension_N": np.full(TIME_S.size, 90.0) + 0.1 * np.cos(follower),
            "true_unwind_angle_rad": unwind,
            "true_swrap_follower_angle_rad": follower,
        }

    rows = more_orders(part(1.0), part(0.01), 6, 0.25, judged=4)
    assert [row.order for row in rows] == [5, 6]
    assert rows[1].before_N == pytest.approx(1.0, rel=0.01)
    assert rows[1].reduction_dB == pytest.approx(40.0, abs=0.2)
    assert more_orders(part(1.0), part(0.01), 4, 0.25, judged=4) == []
