"""What is typed for a step, in SI."""

import math

import pytest

from aff_runtime.app.card.typed_values import TypedValues, typed
from aff_runtime.base.errors import ConfigError
from tests.each_case import each_case


@each_case(
    ("text", "number", "unit"),
    [
        ("load=0", 0.0, ""),
        ("load = 20 lbf", 20.0 * 4.4482216152605, "N"),
        ("speed=300 FPM", 300 * 0.3048 / 60, "m/s"),
        ("time=120 ms", 0.12, "s"),
        ("promised=20 dB", 20.0, "dB"),
        ("reaction=zero", math.nan, ""),
        ("note=3 bananas", math.nan, ""),
    ],
)
def test_a_value_comes_out_in_si(text, number, unit):
    found = typed(text)
    assert found.unit == unit
    assert found.number == pytest.approx(number, nan_ok=True)


@each_case("text", ["", "load", "=3", "a b=3", "load=", "x=" + "9" * 300, "ä=1"])
def test_what_is_no_value_is_refused(text):
    with pytest.raises(ConfigError, match="expected name=value"):
        typed(text)


def test_a_value_of_another_kind_is_refused_and_a_missing_one_is_none():
    values = TypedValues([typed("load=3 m"), typed("reaction=zero")])
    with pytest.raises(ConfigError, match="expected a number in N"):
        values.number("load", "N")
    with pytest.raises(ConfigError, match="expected a number in s"):
        values.number("reaction", "s")
    assert math.isnan(values.number("other", "N"))
    assert (values.word("reaction"), values.word("other")) == ("zero", "")
    with pytest.raises(ConfigError, match="this step does not ask for it; it asks for load"):
        values.refuse_others(["load"])


@pytest.mark.parametrize(("text", "point"), [("20,3 lbf", "20.3 lbf"), ("-1,5", "-1.5")])
def test_a_decimal_comma_is_told_with_what_to_write(text, point):
    values = TypedValues([typed(f"load={text}")])
    with pytest.raises(ConfigError, match=f"load={text}: has a decimal comma; write {point}$"):
        values.number("load", "N")
    assert values.word("load") == text
