"""Turns and orders against the sinusoids that they are made of."""

from __future__ import annotations

import numpy as np
import pytest

from aff_hmi.scope.turns import MOST_ORDERS, orders_of, turns_of
from tests.each_case import each_case

RATE_HZ, TURNS_PER_S = 200.0, 2.3
T_S = np.arange(0.0, 10.0, 1.0 / RATE_HZ)
ANGLE = TURNS_PER_S * T_S


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_turns_are_counted_either_way_over_the_wrap(direction: float) -> None:
    found = turns_of(np.mod(direction * 360.0 * ANGLE + 77.0, 360.0))
    assert found == pytest.approx(ANGLE, abs=1e-9)


def test_where_the_angle_is_not_known_there_are_no_turns() -> None:
    angle = np.mod(360.0 * ANGLE, 360.0)
    angle[100:110] = np.nan
    found = turns_of(angle)
    assert np.isnan(found[100:110]).all()
    assert found[110:] == pytest.approx(ANGLE[110:], abs=1e-9)
    assert np.isnan(turns_of(np.full(5, np.nan))).all()


def test_orders_have_the_amplitudes_that_they_were_made_with() -> None:
    made = {1: 2.0, 2: 0.5, 7: 0.1}
    values = 90.0 + sum(a * np.sin(2.0 * np.pi * k * ANGLE + k) for k, a in made.items())
    orders, floor = orders_of(turns_of(np.mod(360.0 * ANGLE, 360.0)), values)
    # a straight line between ticks takes (pi f / rate)^2 / 6 ... of a sine: f = 7 * 2.3 Hz
    assert orders == pytest.approx([made.get(k, 0.0) for k in range(1, MOST_ORDERS + 1)], abs=0.01)
    assert floor < 0.002


def test_what_does_not_turn_with_the_roll_is_floor_and_no_order() -> None:
    values = 3.0 * np.sin(2.0 * np.pi * 1.5 * ANGLE)
    orders, _ = orders_of(ANGLE, values[: len(ANGLE)])
    assert np.nanmax(orders) < 0.05
    rng = np.random.default_rng(1)
    noisy, floor = orders_of(ANGLE, rng.normal(0.0, 1.0, len(ANGLE)))
    # one line of white noise: Rayleigh, its median sigma * sqrt(2 ln 2) * sqrt(2 / n) or less
    assert 0.2 * np.sqrt(2.0 / len(ANGLE)) < floor < 2.0 * np.sqrt(2.0 / len(ANGLE))
    assert np.median(noisy) == pytest.approx(floor, rel=1.0)


@each_case(
    "turns", [np.zeros(2000), ANGLE[:100], np.full(2000, np.nan), np.linspace(0.0, 900.0, 2000)]
)
def test_less_than_two_turns_or_too_few_samples_tell_nothing(turns: np.ndarray) -> None:
    orders, floor = orders_of(turns, np.ones(len(turns)))
    assert np.isnan(orders).all()
    assert np.isnan(floor)
