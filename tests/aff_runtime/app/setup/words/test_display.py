"""What a technician types off a display."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aff_runtime.app.setup.words.display import shown_value
from aff_runtime.base.units import UnitError
from tests.drawn_text import drawn_text
from tests.each_case import each_case


@each_case(
    ("text", "unit", "value", "half"),
    [
        ("20.3 lbf", "N", 20.3 * 4.4482216152605, 0.05 * 4.4482216152605),
        ("300 FPM", "m/s", 1.524, 0.5 * 0.00508),
        ("8.00 in", "m", 0.2032, 0.005 * 0.0254),
        (" -1.5N ", "N", -1.5, 0.05),
        ("2e1 N", "N", 20.0, 5.0),
        ("1.5E2 N", "N", 150.0, 5.0),
        ("2.50e-1 in", "m", 0.25 * 0.0254, 5e-4 * 0.0254),
    ],
)
def test_value_and_half_a_digit_are_in_si(text: str, unit: str, value: float, half: float) -> None:
    shown = shown_value(text, unit)
    assert shown.value == pytest.approx(value)
    assert shown.half_digit == pytest.approx(half)


@each_case(
    ("text", "unit", "said"),
    [
        ("20.3", "N", "has no unit. Write it as the display has it: N, mN"),
        ("20.3 mm", "N", '"20.3 mm" is a length, expected a force'),
        ("20,3 lbf", "N", "has a decimal comma. Write 20.3 lbf."),
        ("about 20", "N", "is not a number"),
        ("", "N", "is not a number"),
        ("0.0 lbf", "N", "0 tells no scale"),
        ("20.3 bananas", "N", 'unit "bananas" is not known here'),
    ],
)
def test_nonsense_is_told_with_what_to_type(text: str, unit: str, said: str) -> None:
    with pytest.raises(UnitError) as error:
        shown_value(text, unit)
    assert said in str(error.value)


TYPED = st.one_of(
    drawn_text(max_size=130),
    st.text(alphabet="0123456789eE.,+- ", max_size=20).map(lambda text: f"{text} N"),
    st.from_regex(
        r"[-+]?[0-9]{0,4}\.?[0-9]{0,4}([eE][-+]?[0-9]{1,4})? ?(N|lbf|bananas|%)?", fullmatch=True
    ),
)


@given(TYPED)
def test_whatever_is_typed_is_a_value_or_is_told(text: str) -> None:
    try:
        shown = shown_value(text, "N")
    except UnitError:
        return
    assert math.isfinite(shown.value)
    assert shown.half_digit >= 0.0


@given(st.integers(1, 9999), st.integers(-9, 9))
def test_an_exponent_moves_the_last_digit(digits: int, exponent: int) -> None:
    shown = shown_value(f"{digits}e{exponent} N", "N")
    assert shown.value == pytest.approx(digits * 10.0**exponent)
    assert shown.half_digit == pytest.approx(0.5 * 10.0**exponent)
