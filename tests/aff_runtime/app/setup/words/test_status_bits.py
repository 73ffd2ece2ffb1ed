"""Bits that follow a state."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from aff_runtime.app.setup.words.status_bits import BitChange, changed_bits
from tests.aff_runtime.app.setup.virtual_words import Item, euclid, still, watched

QUANTITIES = frozenset(range(2, 15)) - {8}


@given(word=st.integers(0, 0xFFFF), bit=st.integers(0, 15), true_before=st.booleans())
def test_the_bit_that_changed_is_found_with_its_polarity(
    word: int, bit: int, true_before: bool
) -> None:
    others = euclid()
    before = watched([*others, Item(20, "u16", 1.0, still(float(word)))], 1.0)
    after = watched([*others, Item(20, "u16", 1.0, still(float(word ^ 1 << bit)))], 1.0, 5.0)
    found = changed_bits(before, after, true_before=true_before, taken=QUANTITIES)
    was_set = bool(word >> bit & 1)
    assert found[0] == BitChange(address=20, bit=bit, inverted=was_set is not true_before)
    assert {one.address for one in found} == {20}


def test_nothing_changed_is_nothing_found() -> None:
    seen = watched(euclid(), 1.0)
    assert changed_bits(seen, seen, true_before=True) == []


@given(word=st.integers(0, 0xFFFF), bit=st.integers(1, 15))
def test_a_state_that_was_found_may_change_along_with_the_next_one(word: int, bit: int) -> None:
    before = watched([Item(20, "u16", 1.0, still(float(word)))], 1.0)
    after = watched([Item(20, "u16", 1.0, still(float(word ^ (1 << bit | 1))))], 1.0, 5.0)
    found = changed_bits(before, after, true_before=True, owned=frozenset({(20, 0)}))
    assert [(one.address, one.bit) for one in found] == [(20, bit)]
