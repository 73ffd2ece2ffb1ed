"""Angles from their rate against line speed over radius, and from where they carry."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from aff_runtime.app.setup.angles import angle_candidates
from aff_runtime.app.setup.decoding import Decoding
from tests.aff_runtime.app.setup.virtual_words import (
    FOLLOWER_M,
    RADIUS_M,
    SPEED_M_S,
    Item,
    euclid,
    turning,
    watched,
)


@pytest.mark.parametrize("order", ["high_first", "low_first"])
def test_a_carry_shows_the_other_word_and_the_order(order: str) -> None:
    # 65536 counts at 1.016 / 0.1981 / 2 pi turns a second of 4096 counts take 19.6 s
    seen = watched(euclid(order), 25.0)
    unwind = angle_candidates(seen, speed_m_s=SPEED_M_S, radius_m=RADIUS_M)[0]
    follower = angle_candidates(seen, speed_m_s=SPEED_M_S, radius_m=FOLLOWER_M)[0]
    assert unwind.decoding == Decoding(address=11, type="i32", order=order)
    assert follower.decoding == Decoding(address=13, type="i32", order=order)
    assert unwind.scale_text == follower.scale_text == "4096 counts/turn"


def test_a_word_that_wraps_alone_is_one_word() -> None:
    angle = 2.0 * math.pi / 65536
    seen = watched([Item(3, "u16", angle, turning(5.0)), Item(4, "u16", 1.0, lambda _: 7.0)], 4.0)
    best = angle_candidates(seen, speed_m_s=1.0, radius_m=0.2)[0]
    assert best.decoding == Decoding(address=3, type="u16")
    assert best.scale_text == "65536 counts/turn"
    assert "wraps at 65536" in best.why


def test_counting_against_the_web_is_negative() -> None:
    seen = watched([Item(3, "i16", -2.0 * math.pi / 1024, turning(5.0))], 4.0)
    assert angle_candidates(seen, speed_m_s=1.0, radius_m=0.2)[0].counts_per_turn == -1024


def test_a_count_that_starts_over_each_turn_is_said_to_be_no_use() -> None:
    seen = watched([Item(3, "u16", 1.0, lambda t_s: (4096 * 0.8 * t_s) % 4096)], 6.0)
    best = angle_candidates(seen, speed_m_s=1.0, radius_m=1.0 / (2.0 * math.pi * 0.8))[0]
    assert not best.usable
    assert any("Let the PLC count on" in reason for reason in best.why)


@settings(deadline=None, max_examples=60)
@given(
    counts=st.sampled_from([1024, 2000, 2048, 4096, 8192, 10000, 16384, 65536]),
    speed=st.floats(0.3, 5.0),
    radius=st.floats(0.08, 0.4),
    error=st.floats(-0.008, 0.008),
)
def test_the_encoder_is_among_the_first_three(
    counts: int, speed: float, radius: float, error: float
) -> None:
    item = Item(8, "u16", 2.0 * math.pi / counts, turning(speed / radius))
    rows = angle_candidates(watched([item], 4.0), speed_m_s=speed * (1.0 + error), radius_m=radius)
    assert counts in [one.counts_per_turn for one in rows[:3]]
