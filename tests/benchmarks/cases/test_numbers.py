"""How far found numbers are off hidden ones, whatever either code calls them."""

import math

import pytest

from benchmarks.cases.numbers import Declared, errors
from tests.each_case import each_case

LINE = Declared(wound_strain=0.01, cell_Hz=20.0)


def off(effect, hidden, found):
    verdict = {"effects": [{"effect": effect, "parameters": found}]}
    return errors({"effect_class": effect, "parameters": hidden}, verdict, LINE)


@each_case(
    ("effect", "hidden", "found", "expected"),
    [
        ("eccentric_roller", {"eccentricity_m": 2e-4}, {"eccentricity_m": 2.04e-4}, 2.0),
        ("radius_error", {"relative": -0.005}, {"ratio": 0.99495}, 1.0),
        (
            "shaft_compliance_backlash",
            {"stiffness_N_m_rad": 80.0, "gap_rad": 0.0},
            {"compliance_rad_N_m": 1 / 84.0, "backlash_rad": 0.0},
            5.0,
        ),
        (
            "load_cell_filter",
            {"corner_Hz": 4.0},
            {"lag_s": (1 / 4.0 - 1 / 20.0) / (2 * math.pi)},
            0.0,
        ),
        ("wound_in_strain", {"factor": 1.5}, {"strain": 0.0053}, 2.0),
    ],
)
def test_a_number_is_compared_by_the_meaning_that_the_label_gives_it(
    effect, hidden, found, expected
):
    assert list(off(effect, hidden, found).values()) == pytest.approx([expected], abs=1e-9)


@each_case(
    ("effect", "hidden", "found"),
    [
        ("torque_ripple", {"order": 6}, {"order": 6.0}),
        ("bearing_drag", {"from_record_time_s": {"a": 20.0}}, {"from_s": 20.0}),
        ("out_of_round_roll", {"shape": "flat", "size_m": 1e-3}, {"shape": "asym", "size_m": 1}),
        ("roll_bounce", {"damping": 0.05}, {"damping": 0.0}),
    ],
)
def test_orders_moments_other_shapes_and_what_no_record_shows_are_not_compared(
    effect, hidden, found
):
    assert off(effect, hidden, found) == {}


def test_nothing_is_compared_with_another_effect():
    effect = {"effect_class": "slip", "parameters": {"above_m_s": 1.0}}
    assert errors(effect, {"effects": [{"effect": "splice", "parameters": {}}]}, LINE) == {}
