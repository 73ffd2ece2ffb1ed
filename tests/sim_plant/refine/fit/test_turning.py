"""What turns together, which orders it has, and after which part of a turn it is as it was."""

import math

import pytest

from sim_plant.refine.fit.turning import Turning, has_start_angle, orders_of
from sim_plant.refine.model.twin import Added
from tests.each_case import each_case


def test_an_angle_makes_an_effect_one_that_is_turned():
    assert has_start_angle(Added("eccentric_roller", "R6", (("cos_m", 1e-4),)))
    assert not has_start_angle(Added("loop_delay", "unwind", (("delay_s", 0.05),)))


def added(effect, location, **parameters):
    return Added(effect, location, tuple(parameters.items()))


@each_case(
    ("orders", "tries", "part"),
    [((1.0,), 24, 1.0), ((36.0,), 24, 36.0), ((1.0, 36.0), 144, 1.0), ((24.0, 36.0), 24, 12.0)],
)
def test_the_first_grid_has_four_tries_in_a_period_of_the_highest_order(orders, tries, part):
    both = [
        added("torque_ripple", "unwind", order=n, amplitude_N_m=1.0, angle_rad=0.0) for n in orders
    ]
    turning = Turning.of("unwind", both)
    assert turning.angle_count == tries
    assert turning.period_rad == pytest.approx(2.0 * math.pi / part)


def test_orders_that_are_there_count_and_no_others():
    profile = {"shape": "orders", "cos2_m": 1e-4, "sin6_m": 1e-4, "cos4_m": 0.0}
    assert orders_of(added("out_of_round_roll", "unwind", **profile)) == {2.0, 6.0}
    flat = {"shape": "flat", "size_m": 0.01, "angle_rad": 0.0}
    assert orders_of(added("out_of_round_roll", "unwind", **flat)) == {
        1.0,
        2.0,
        3.0,
        4.0,
        5.0,
        6.0,
    }
    hum = {"frequency_Hz": 49.7, "cos_N": 1.0}
    assert orders_of(added("mains_hum", "R3", **hum)) == {1.0}
    nip = {"nip_radius_m": 0.03, "cos_N": 1.0}
    assert orders_of(added("nip_pulse", "pull_roll", **nip)) == {1.0}
