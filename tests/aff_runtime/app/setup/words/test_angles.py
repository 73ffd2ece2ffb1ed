"""Angles from their rate against line speed over radius, and from where they carry."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from aff_runtime.app.setup.words.angles import AngleCandidate, angle_candidates, beside, doubt
from aff_runtime.app.setup.words.decoding import Decoding
from aff_runtime.app.setup.words.reading import Watched
from aff_runtime.app.setup.words.turns import AGREED, UNSEEN, counts_per_turn
from tests.aff_runtime.app.setup.virtual_words import (
    FOLLOWER_M,
    RADIUS_M,
    SPEED_M_S,
    Item,
    euclid,
    turning,
    watched,
)
from tests.each_case import each_case


def found(seen: Watched, speed_m_s: float, radius_m: float) -> list[AngleCandidate]:
    """Return the candidates where the web moves evenly."""
    speeds_m_s = [speed_m_s] * len(seen.times_s)
    return angle_candidates(seen, speeds_m_s=speeds_m_s, radius_m=radius_m)


@pytest.mark.parametrize("order", ["high_first", "low_first"])
def test_a_carry_shows_the_other_word_and_the_order(order: str) -> None:
    # 65536 counts at 1.016 / 0.1981 / 2 pi turns a second of 4096 counts take 19.6 s
    seen = watched(euclid(order), 25.0)
    unwind = found(seen, SPEED_M_S, RADIUS_M)[0]
    follower = found(seen, SPEED_M_S, FOLLOWER_M)[0]
    assert unwind.decoding == Decoding(address=11, type="i32", order=order)
    assert follower.decoding == Decoding(address=13, type="i32", order=order)
    assert unwind.scale_text == follower.scale_text == "4096 counts/turn"


def test_a_word_that_wraps_alone_is_one_word() -> None:
    angle = 2.0 * math.pi / 65536
    seen = watched([Item(3, "u16", angle, turning(5.0)), Item(4, "u16", 1.0, lambda _: 7.0)], 4.0)
    best = found(seen, 1.0, 0.2)[0]
    assert best.decoding == Decoding(address=3, type="u16")
    assert best.scale_text == "65536 counts/turn"
    assert "wraps at 65536" in best.why


def test_counting_against_the_web_is_negative() -> None:
    seen = watched([Item(3, "i16", -2.0 * math.pi / 1024, turning(5.0))], 4.0)
    assert found(seen, 1.0, 0.2)[0].counts_per_turn == -1024


@each_case(
    ("counts", "turns", "lowest", "word"),
    [
        (4096, 1, 0, "u16"),
        (3600, 1, -1800, "i16"),
        (36000, 1, 0, "u16"),
        (36000, 1, -18000, "i16"),
        (1000, 3, 0, "u16"),
        (4096, 4, -8192, "i16"),
    ],
)
@each_case("turns_per_s", [0.8, -0.8])
def test_a_count_that_starts_over_after_whole_turns_says_after_how_many(
    counts: int, turns: int, lowest: int, word: str, turns_per_s: float
) -> None:
    whole = counts * turns
    seen = watched(
        [Item(3, word, 1.0, lambda t_s: lowest + (counts * turns_per_s * t_s + 100) % whole)], 12.0
    )
    best = found(seen, 1.0, 1.0 / (2.0 * math.pi * 0.8))[0]
    assert best.usable
    assert best.decoding == Decoding(address=3, type=word)
    assert best.counts_per_turn == math.copysign(counts, turns_per_s)
    assert best.wraps_after == whole


def test_a_count_that_starts_over_after_no_whole_turns_is_said_to_be_no_use() -> None:
    seen = watched([Item(3, "u16", 1.0, lambda t_s: (4096 * 0.8 * t_s) % 6144)], 8.0)
    best = found(seen, 1.0, 1.0 / (2.0 * math.pi * 0.8))[0]
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
    rows = found(watched([item], 4.0), speed * (1.0 + error), radius)
    assert counts in [one.counts_per_turn for one in rows[:3]]


def out_of_round(counts: int, turns_per_s: float, swing: float, phase: float) -> Item:
    """A roll whose speed swings once a turn by ``swing`` of its mean, at a web that does not."""

    def angle_rad(t_s: float) -> float:
        mean = 2.0 * math.pi * turns_per_s * t_s
        return mean + swing * (math.sin(mean + phase) - math.sin(phase))

    return Item(8, "u16", 2.0 * math.pi / counts, angle_rad)


@settings(deadline=None, max_examples=60)
@given(
    turns_per_s=st.floats(0.35, 12.0),
    swing=st.floats(0.0, 0.06),
    phase=st.floats(0.0, 6.28),
    error=st.floats(-0.009, 0.009),
)
def test_whole_turns_tell_4096_from_4000_whatever_the_ripple_of_the_roll(
    turns_per_s: float, swing: float, phase: float, error: float
) -> None:
    radius_m, seconds = 0.15, max(3.0, 3.05 / turns_per_s)
    speed_m_s = 2.0 * math.pi * radius_m * turns_per_s * (1.0 + error)
    seen = watched([out_of_round(4096, turns_per_s, swing, phase)], seconds)
    rows = found(seen, speed_m_s, radius_m)
    assert rows[0].counts_per_turn == 4096
    assert "another" not in doubt(rows)
    held = [one.counts_per_turn for one in rows if one.is_held]
    assert held == [4096]
    assert rows[0].measured.counts == pytest.approx(4096 / (1.0 + error), rel=0.004)


@pytest.mark.parametrize("seconds", [2.2, 3.0, 3.4])
def test_a_part_of_a_turn_would_be_off_by_the_ripple_of_the_roll(seconds: float) -> None:
    turns_per_s, swing = 0.816, 0.06  # 200 FPM at 0.198 m
    seen = watched([out_of_round(4096, turns_per_s, swing, 0.0)], seconds)
    path = [count - seen.words[8][0] for count in seen.words[8]]
    web_m = 2.0 * math.pi * 0.198 * turns_per_s
    measured = counts_per_turn(seen.times_s, path, [web_m] * len(path), 0.198)
    assert measured is not None
    assert measured.counts == pytest.approx(4096, rel=0.0025)
    assert measured.off < 0.016
    plain = path[-1] / (turns_per_s * seen.duration_s)
    assert abs(plain / 4096 - 1.0) > 2.0 * abs(measured.counts / 4096 - 1.0)


def test_less_than_a_turn_is_said_and_decides_nothing_between_neighbours() -> None:
    seen = watched([out_of_round(4096, 0.2, 0.05, 1.0)], 4.0)
    rows = found(seen, 2.0 * math.pi * 0.3 * 0.2, 0.3)
    assert rows[0].measured.off == UNSEEN
    assert {one.counts_per_turn for one in rows if one.is_held} >= {4000, 4096}
    assert doubt(rows).startswith("another")
    assert "in less than one turn" in rows[0].why


def test_a_radius_that_is_off_is_said_and_nothing_is_taken_unasked() -> None:
    seen = watched([out_of_round(4096, 0.8, 0.0, 0.0)], 5.0)
    rows = found(seen, 2.0 * math.pi * 0.2 * 0.8, 0.2 * 1.025)  # 4198 counts: no usual number
    assert rows[0].counts_per_turn == 4096
    assert not rows[0].is_held
    assert doubt(rows).startswith("another")
    assert "not this number if radius and line speed are right" in rows[0].why


def test_speed_that_wanders_while_it_is_watched_changes_nothing() -> None:
    seen = watched([Item(8, "u16", 2.0 * math.pi / 2048, lambda t: 5.0 * (t + 0.1 * t * t))], 6.0)
    speeds_m_s = [0.2 * 5.0 * (1.0 + 0.2 * t) for t in seen.times_s]
    best, *_ = angle_candidates(seen, speeds_m_s=speeds_m_s, radius_m=0.2)
    assert best.counts_per_turn == 2048
    assert best.measured.counts == pytest.approx(2048, rel=1e-3)
    assert best.measured.off == pytest.approx(AGREED, abs=1e-4)


TWINS = (0.15, 0.15367)  # 4096 counts of the second, read as the first, are 3998


def twins(seconds: float = 4.0) -> Watched:
    """Two rollers of nearly one size, each with 4096 counts a turn."""
    scale = math.tau / 4096
    return watched(
        [Item(11, "i32", scale, turning(6.0 / TWINS[0])),
         Item(13, "i32", scale, turning(6.0 / TWINS[1], 1.0))], seconds,
    )  # fmt: skip


def test_of_two_rollers_nearly_as_large_neither_is_taken_for_the_other() -> None:
    seen = twins()
    first, second = (found(seen, 6.0, radius) for radius in TWINS)
    assert {(one.low_word, one.counts_per_turn) for one in first if one.is_held} == {
        (12, 4096), (14, 4000)
    }  # fmt: skip
    assert doubt(first).startswith("another")
    rows = beside(first, second, "swrap_follower")
    assert (rows[0].decoding.address, rows[0].counts_per_turn) == (11, 4096)
    assert doubt(rows) == ""
    (behind,) = {one.why[-1] for one in rows if one.low_word == 14 and one.is_held}
    assert behind == "then no word is left that can be swrap_follower"
    assert doubt(beside(second, first, "unwind")) == ""


def test_a_roller_without_an_encoder_holds_up_nothing() -> None:
    seen = watched([Item(11, "i32", math.tau / 4096, turning(6.0 / TWINS[0]))], 4.0)
    first, second = (found(seen, 6.0, radius) for radius in TWINS)
    assert beside(first, second, "swrap_follower") == first
    assert doubt(first) == ""
