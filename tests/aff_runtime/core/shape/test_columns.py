"""What a law keeps per order has one owner: it forgets and goes on as a whole."""

from __future__ import annotations

import math

import numpy as np
import pytest

from aff_runtime.core.shape.columns import ColumnState, common


def test_a_new_array_holds_its_fresh_value_in_every_column():
    state = ColumnState(3)
    assert state.array("a.now", math.nan).tolist() == pytest.approx([math.nan] * 3, nan_ok=True)
    assert state.array("a.low", dtype=np.complex128, rows=2).shape == (2, 3)
    assert state.array("a.held", False, dtype=np.bool_).dtype == np.bool_


def test_a_quantity_has_one_keeper():
    state = ColumnState(1)
    state.array("a.share")
    with pytest.raises(ValueError, match=r"a\.share"):
        state.array("a.share")


def test_forgetting_touches_the_rolls_own_numbers_in_its_own_columns():
    state = ColumnState(3)
    weight, share = state.array("a.weight", of_roll=True), state.array("a.share", 1.0)
    rows = state.array("a.rows", 7.0, rows=2, of_roll=True)
    weight[:], share[:], rows[:] = 5.0, 0.5, 1.0
    state.forget(np.array([False, True, False]))
    assert weight.tolist() == [5.0, 0.0, 5.0]
    assert share.tolist() == [0.5, 0.5, 0.5]
    assert rows.tolist() == [[1.0, 7.0, 1.0], [1.0, 7.0, 1.0]]


def test_an_edit_takes_common_columns_over_by_name_and_starts_the_others_afresh():
    old, new = ColumnState(2), ColumnState(3)
    theirs, mine = old.array("a.weight"), new.array("a.weight", 9.0)
    only_new = new.array("b.share", 1.0)
    old.array("c.gone")
    theirs[:] = [1.0, 2.0]
    new.adopt(old, common(["r_2x", "r_3x", "r_1x"], ["r_1x", "r_2x"]))
    assert mine.tolist() == [2.0, 9.0, 1.0]
    assert only_new.tolist() == [1.0, 1.0, 1.0]
    theirs[:] = 0.0
    assert mine.tolist() == [2.0, 9.0, 1.0]  # a copy, not a view
