import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim_plant.servers.words import RegisterItem
from tests.each_case import each_case


@each_case(
    ("type_", "scale", "value", "words"),
    [
        ("u16", 0.01, 88.96, (8896,)),
        ("i16", 0.001, -1.016, (0xFC08,)),  # 65536 - 1016
        ("i32", 0.001, 89.2, (0x0001, 0x5C70)),  # 89200 = 0x15C70
        ("i32", 0.001, -0.001, (0xFFFF, 0xFFFF)),
        ("u32", 1.0, 0x12345678, (0x1234, 0x5678)),
        ("f32", 1.0, 1.0, (0x3F80, 0x0000)),
    ],
)
def test_values_become_the_words_of_twos_complement_and_ieee_754(type_, scale, value, words):
    item = RegisterItem(name="x", address=0, type=type_, scale=scale)
    assert item.to_words(value) == words
    assert item.to_words(value, low_first=True) == words[::-1]


@each_case(
    ("type_", "value", "words"),
    [
        ("u16", -1.0, (0,)),
        ("u16", 1e9, (0xFFFF,)),
        ("i16", -1e9, (0x8000,)),
        ("i16", math.inf, (0x7FFF,)),
        ("i32", 1e12, (0x7FFF, 0xFFFF)),
        ("f32", 1e300, (0x7F7F, 0xFFFF)),
        ("i16", math.nan, (0x8000,)),
        ("u32", math.nan, (0xFFFF, 0xFFFF)),
        ("f32", math.nan, (0x7FC0, 0x0000)),
    ],
)
def test_what_does_not_fit_is_clipped(type_, value, words):
    assert RegisterItem(name="x", address=0, type=type_).to_words(value) == words


def test_a_wrapping_counter_rolls_over():
    item = RegisterItem(name="x", address=0, type="i32", wraps=True)
    assert item.to_words(2.0**31) == (0x8000, 0x0000)
    assert item.to_words(2.0**32 + 5) == (0x0000, 0x0005)


@given(st.floats(-30.0, 30.0), st.booleans(), st.sampled_from(["i16", "i32"]))
def test_reading_back_is_exact_to_half_a_count(value, low_first, type_):
    item = RegisterItem(name="x", address=0, type=type_, scale=0.001)
    back = item.from_words(item.to_words(value, low_first=low_first), low_first=low_first)
    assert abs(back - value) <= 0.0005 + 1e-12


@each_case(
    ("type_", "wraps", "words", "value"),
    [
        ("i16", False, (0x8000,), math.nan),
        ("i16", False, (0x7FFF,), 32767.0),
        ("u16", False, (0xFFFF,), math.nan),
        ("u16", False, (0,), 0.0),
        ("i32", False, (0x0000, 0x8000), math.nan),
        ("i32", True, (0x0000, 0x8000), -(2.0**31)),
        ("f32", False, (0x0000, 0x7FC0), math.nan),
        ("f32", False, (0x0000, 0x3F80), 1.0),
    ],
)
def test_a_reading_that_nobody_measures_is_no_number(type_, wraps, words, value):
    item = RegisterItem(name="x", address=0, type=type_, wraps=wraps)
    assert item.reading(words, low_first=True) == pytest.approx(value, nan_ok=True)
