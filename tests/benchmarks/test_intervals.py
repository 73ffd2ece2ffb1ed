"""Draws for intervals: effects of known numbers, and how an interval is held against them."""

import pytest

from benchmarks.intervals import drawn, draws, error_ratio, forms, page, true_numbers
from sim_plant.refine.fit.spread import SPREAD


def number(value, true, low, high):
    return {"name": "size", "value": value, "true": true, "low": low, "high": high}


def test_every_draw_is_one_effect_within_the_bounds_of_its_form_and_the_same_again():
    for turn in range(2):
        for at, (row, _, form) in enumerate(forms()):
            (fault,) = drawn(turn, at).faults
            assert fault.effect == row.name
            assert form.least <= abs(fault.size) <= form.largest
            assert drawn(turn, at).faults == (fault,)


def test_of_what_begins_the_moment_is_true_as_well():
    begun = [case for _, case in draws(1, "") if case.faults[0].from_s >= 0.0]
    assert begun
    true = true_numbers(begun[0])
    assert true["from_s"] == begun[0].faults[0].from_s
    assert true["at_length_m"] > 0.0


def test_draws_are_taken_by_name():
    assert [name for name, _ in draws(2, "rate_limit")] == [
        name for name, _ in draws(2, "") if "rate_limit" in name
    ]


def test_an_error_counts_by_the_side_of_the_interval_that_it_lies_on():
    uneven = number(1.0, 1.2, 0.9, 1.0 + 0.1 * SPREAD)
    assert error_ratio(uneven) == pytest.approx(-2.0)
    assert error_ratio({**uneven, "true": 0.95}) == pytest.approx(0.05 / (0.1 / SPREAD))


def test_the_page_counts_what_is_held_and_names_what_no_fit_stands_of():
    rows = [
        {"name": "a", "effect": "drag", "numbers": [number(1.0, 1.05, 0.9, 1.1)], "excess": 0.0},
        {"name": "b", "effect": "drag", "numbers": [number(1.0, 2.0, 0.9, 1.1)], "excess": 0.0},
        {"name": "c", "effect": "slip", "numbers": [], "excess": 0.0},
    ]
    text = page(rows)
    assert "| drag | size | 1 of 2 |" in text
    assert "1 of 2 held" in text
    assert "no fit stands: c" in text
