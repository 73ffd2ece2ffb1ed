"""Plant units at the edge: factors from their definitions, errors that say what to write."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aff_runtime.base.units import (
    UnitError,
    accepted_units,
    plain,
    read_number,
    read_scale,
    unit_info,
)
from tests import quick_yaml
from tests.drawn_text import drawn_text
from tests.each_case import each_case


@each_case(
    ("text", "unit", "expected"),
    [
        ("300 m/min", "m/s", 5.0),
        ("0.4 m/min", "m/s", 0.4 / 60),
        ("200 FPM", "m/s", 200 * 12 * 0.0254 / 60),
        ("200 fpm", "m/s", 1.016),
        ("200FPM", "m/s", 1.016),
        ("20 lbf", "N", 20 * 0.45359237 * 9.80665),
        ("8 in", "m", 0.2032),
        ("2 GPa", "Pa", 2e9),
        ("3 N/mm2", "Pa", 3e6),
        ("30 psi", "Pa", 30 * 0.45359237 * 9.80665 / 0.0254**2),
        ('8"', "m", 0.2032),
        ("10 ms", "s", 0.010),
        ("0.003 s", "ms", 3.0),
        ("15 deg", "rad", math.pi / 12),
        ("15°", "rad", math.pi / 12),
        ("1500 rpm", "rad/s", 50 * math.pi),
        ("-2.5e-3 kN", "N", -2.5),
        ("1 lbf in", "N m", 0.45359237 * 9.80665 * 0.0254),
        ("3 N·m", "N m", 3.0),
        ("4 m/min/s", "m/s2", 4 / 60),
        ("2 GB", "MB", 2000.0),
        ("25 %", "", 0.25),
    ],
)
def test_text_with_a_unit_becomes_the_keys_unit(text, unit, expected):
    assert read_number(text, unit) == pytest.approx(expected, rel=1e-12)


@each_case("unit", ["m", "m/s", "ms", "N", ""])
def test_bare_number_already_is_in_the_keys_unit(unit):
    assert read_number(7, unit) == 7.0
    assert read_number(0.25, unit) == 0.25


@each_case(
    ("value", "unit", "said"),
    [
        ("20 lbf", "m/s", '"20 lbf" is a force, expected a speed'),
        ("8 in", "s", '"8 in" is a length, expected a time'),
        ("15 deg", "", '"15 deg" is an angle, expected a plain number'),
        ("1e-3", "s", '"1e-3" is text, not a number (YAML 1.1). Write 0.001.'),
        ("3e5", "N", '"3e5" is text, not a number (YAML 1.1). Write 300000.'),
        ("0,05", "m/s", '"0,05" has a decimal comma. Write 0.05.'),
        ("0,05 m/s", "m/s", '"0,05 m/s" has a decimal comma. Write 0.05 m/s.'),
        ("fast", "m/s", '"fast" is not a number'),
        ("5 parsec", "m", 'unit "parsec" is not known here'),
        ("", "m", "is not a number"),
        ("nan", "m", "is not a number"),
        ("inf m", "m", "is not a number"),
        ("1e999 m", "m", "is not a finite number"),
        ("1e308 km/h", "", "expected a plain number"),
        (math.nan, "m", "is not a finite number"),
        (math.inf, "m", "is not a finite number"),
        (10**400, "m", "is not a finite number"),
        (True, "m", "true is not a number"),
        (None, "m", "nothing is not a number"),
        ([1], "m", "a list is not a number"),
        ({}, "m", "a section is not a number"),
    ],
)
def test_wrong_value_is_refused_with_what_to_write(value, unit, said):
    with pytest.raises(UnitError) as caught:
        read_number(value, unit)
    assert said in str(caught.value)


def test_mega_and_milli_newton_metre_are_not_confused_by_case():
    assert read_number("5 mN", "N") == pytest.approx(0.005)
    with pytest.raises(UnitError):
        read_number("5 MN", "ms")


@given(st.floats(min_value=-1e6, max_value=1e6), st.sampled_from(["m", "m/s", "N", "s", "rad"]))
def test_every_accepted_unit_goes_there_and_back(number, unit):
    for other in accepted_units(unit):
        converted = read_number(f"{number!r} {other}", unit)
        here, there = unit_info(unit), unit_info(other)
        assert here is not None
        assert there is not None
        back = converted * here.si_per_unit / there.si_per_unit
        assert back == pytest.approx(number, rel=1e-12, abs=1e-300)


@given(drawn_text(max_size=30), st.sampled_from(["m", "m/s", "", "ms"]))
def test_any_text_gives_a_finite_number_or_a_unit_error(text, unit):
    try:
        number = read_number(text, unit)
    except UnitError:
        return
    assert math.isfinite(number)


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_plain_number_is_one_that_yaml_reads_as_a_number(number):

    read = quick_yaml.safe_load(plain(number))
    assert isinstance(read, int | float)
    assert read == pytest.approx(number, rel=1e-6, abs=1e-12)


@pytest.mark.parametrize("text", ["4096 counts/turn", "4096counts / rev", "4096.0 cts/turn"])
def test_counts_per_turn_are_a_scale_of_an_angle(text):
    # the float of 2 pi over a power of two is exact
    assert read_scale(text, "rad") == 2 * math.pi / 4096 == 0.0015339807878856412
    assert read_scale(f"-{text}", "rad") == -2 * math.pi / 4096


@pytest.mark.parametrize(
    ("text", "unit", "said"),
    [
        ("4096 counts/turn", "m", "counts/turn is for an angle, expected a length: a number in m"),
        ("0 counts/turn", "rad", "Write 4096 counts/turn."),
        ("4096 counts", "rad", 'unit "counts" is not known here'),
    ],
)
def test_counts_per_turn_elsewhere_are_refused(text, unit, said):
    with pytest.raises(UnitError, match=said):
        read_scale(text, unit)


def test_any_other_scale_is_a_number():
    assert read_scale("0.5 deg", "rad") == pytest.approx(math.pi / 360)
    assert read_scale(0.001, "N") == 0.001
