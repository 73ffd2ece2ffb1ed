"""Draws for intervals: effects of known numbers, and how an interval is held against them."""

import pytest

from benchmarks.intervals.draws import drawn, draws, forms, true_numbers
from benchmarks.intervals.page import document, error_ratio, estimated, number_class, page
from sim_plant.refine.fit.spread import SPREAD
from tests.each_case import each_case


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


def test_numbers_are_of_a_kind_by_unit_and_part():
    assert number_class("loop_delay", "delay_s") == "time constant, delay, duration"
    assert number_class("thermal_strain", "from_s") == "moment, place in the web"
    assert number_class("splice", "at_length_m") == "moment, place in the web"
    assert number_class("load_cell_resonance", "frequency_Hz") == "frequency"
    assert number_class("rate_limit", "slew_m_s2") == "size"
    assert number_class("torque_ripple", "amplitude_N_m") == "size"
    assert number_class("slip", "threshold_m_s") == "shape, threshold, mass, damping"


def rows(held, missed, effect="bearing_drag", name="constant_N_m"):
    one = {"name": name, "value": 1.0, "low": 0.9, "high": 1.1}
    numbers = [{**one, "true": 1.05}] * held + [{**one, "true": 2.0}] * missed
    return [{"name": "a", "effect": effect, "numbers": numbers, "excess": 5.0}]


def test_the_page_counts_what_is_held_and_names_what_no_fit_stands_of():
    gone = {"name": "c", "effect": "slip", "numbers": [], "excess": 0.0}
    text = page([*rows(1, 1), gone])
    assert "| bearing_drag | constant_N_m | 1 of 2 |" in text
    assert "Not held: a constant_N_m: 1 (0.9 to 1.1), true 2." in text
    assert "No fit stands: c." in text


@each_case(
    ("held", "missed", "says"),
    [(95, 5, "met"), (80, 20, "**missed**"), (9, 1, "met"), (10, 0, "too few draws to say")],
)
def test_a_share_is_missed_only_where_both_ends_of_it_are_outside(held, missed, says):
    assert f"| {says} |" in page(rows(held, missed)).split("| size |")[1].splitlines()[0]


def test_the_document_names_its_command_and_what_leaves_more_than_noise():
    text = document(rows(9, 1), 2)
    assert "python -m benchmarks.intervals --rounds 2 --docs" in text
    assert "in 1 of\n1 draws: a." in text


def test_what_is_no_estimate_is_not_counted():
    """A fit that left the record as it was, and a number that may lie anywhere."""
    broken = {**rows(1, 0)[0], "excess": 1e6}
    nowhere = {"name": "backlash_rad", "value": 0.0, "true": 0.002, "low": 0.0, "high": 0.1}
    lost = {
        "name": "c",
        "effect": "shaft_compliance_backlash",
        "numbers": [nowhere],
        "excess": 0.0,
    }
    assert [estimated(row) for row in (broken, lost)] == [[], []]
    assert len(estimated(rows(1, 1)[0])) == 2
