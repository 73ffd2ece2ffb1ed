from __future__ import annotations

from math import pi

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aff_runtime.safety.envelope import Envelope
from tests.each_case import each_case

DT_S = 0.005
SOFT_S, FADE_S = 1.5, 0.150


def envelope() -> Envelope:
    return Envelope(soft_start_s=SOFT_S, fade_s=FADE_S)


def test_it_opens_as_a_raised_cosine() -> None:
    gate = envelope()
    levels = [gate.step(True, DT_S) for _ in range(300)]
    assert levels[99] == pytest.approx(0.25)  # a third of the way: (1 - cos 60°) / 2
    assert levels[149] == pytest.approx(0.5)
    assert levels[199] == pytest.approx(0.75)
    assert levels[299] == pytest.approx(1.0)
    assert levels == sorted(levels)


@each_case("opened_ticks", [1, 10, 77, 150, 300, 1000])
def test_it_is_exactly_zero_one_fade_after_any_point(opened_ticks: int) -> None:
    gate = envelope()
    for _ in range(opened_ticks):
        gate.step(True, DT_S)
    levels = [gate.step(False, DT_S) for _ in range(30)]
    assert levels[-1] == 0.0
    assert levels == sorted(levels, reverse=True)


def test_a_step_longer_than_the_fade_closes_at_once() -> None:
    gate = envelope()
    gate.step(True, 2.0)
    assert gate.level == pytest.approx(1.0)
    assert gate.step(False, 0.2) == 0.0


@given(st.lists(st.booleans(), max_size=400))
def test_it_never_steps_whatever_the_order_of_reversals(wishes: list[bool]) -> None:
    gate = envelope()
    steepest = pi / 2 * DT_S / FADE_S
    before = 0.0
    for wanted in wishes:
        level = gate.step(wanted, DT_S)
        assert 0.0 <= level <= 1.0
        assert abs(level - before) <= steepest * (1 + 1e-9)
        assert level >= before - 1e-12 if wanted else level <= before
        before = level


def test_shut_it_is_zero_at_once_and_opens_again_from_there() -> None:
    gate = envelope()
    for _ in range(200):
        gate.step(True, DT_S)
    gate.shut()
    assert gate.level == 0.0
    assert gate.step(False, DT_S) == 0.0
    again = [gate.step(True, DT_S) for _ in range(300)]
    assert again[99] == pytest.approx(0.25)
