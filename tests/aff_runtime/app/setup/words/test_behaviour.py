"""What words do, seen from formulas."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aff_runtime.app.setup.words.behaviour import Kind, behaviours, heartbeats
from tests.aff_runtime.app.setup.virtual_words import (
    PERIOD_S,
    Item,
    euclid,
    ripple,
    still,
    turning,
    watched,
)


def kind(item: Item, seconds: float = 3.0) -> Kind:
    return behaviours(watched([item], seconds))[item.address].kind


def test_each_word_of_the_default_block_does_what_it_is() -> None:
    does = behaviours(watched(euclid()))
    assert does[0].kind is Kind.COUNTER
    assert does[0].rate_per_s == pytest.approx(200.0, rel=0.01)
    assert [does[place].kind for place in (1, 2, 4, 6, 8)] == [Kind.STILL] * 5
    assert [does[place].kind for place in (3, 5, 7, 10)] == [Kind.NOISY] * 4
    assert [does[place].kind for place in (12, 14)] == [Kind.RAMP] * 2


@given(period_ms=st.sampled_from([1, 2, 5, 10, 20, 50, 100]), phase=st.floats(0.0, 1.0))
def test_the_heartbeat_of_any_scan_is_found_beside_everything_else(
    period_ms: int, phase: float
) -> None:
    beat = Item(30, "u16", 1.0, lambda t_s: math.floor(t_s * 1e3 / period_ms + phase))
    best = heartbeats(watched([*euclid()[1:], beat]))[0]
    assert best.address == 30
    assert best.period_ms == pytest.approx(period_ms, rel=0.05)


def test_a_copy_of_our_heartbeat_that_stands_is_no_heartbeat() -> None:
    assert [one.address for one in heartbeats(watched(euclid()))] == [0]


def test_a_counter_that_starts_over_within_its_word_says_where() -> None:
    seen = watched([Item(3, "u16", 1.0, lambda t_s: (1500.0 * t_s) % 4096)], 6.0)
    does = behaviours(seen)[3]
    assert does.wraps_after == pytest.approx(4096, abs=1500.0 * PERIOD_S)
    assert "starts over at" in str(does)


def test_a_swing_is_no_ramp_and_a_toggling_bit_is_a_bit() -> None:
    assert kind(Item(5, "i16", 0.001, ripple(1.0, 0.01, 0.2)), 2.0) is not Kind.COUNTER
    assert kind(Item(5, "u16", 1.0, lambda t_s: 64 * (math.floor(t_s) % 2))) is Kind.BITS
    assert kind(Item(5, "u16", 1.0, still(9.0))) is Kind.STILL
    assert kind(Item(5, "u16", 1.0, turning(-900.0, 5000.0))) is Kind.RAMP
