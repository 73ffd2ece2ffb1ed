import json
import math

import pytest

from aff_runtime.base.numbers import finite_or_none
from tests.each_case import each_case


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_what_json_has_no_word_for_is_null(value):
    assert json.dumps(finite_or_none(value), allow_nan=False) == "null"
    assert finite_or_none(value, 5) is None


@each_case("value", [0.0, -1.5, 1e-300, 123456.789])
def test_a_finite_number_stays_as_it_is(value):
    assert finite_or_none(value) == value


@each_case("value", [0.000123456, 123456.789, -98765.4321])
@each_case("digits", [4, 7])
def test_a_rounded_number_is_off_by_half_a_digit_at_most(value, digits):
    unit = 10.0 ** (math.floor(math.log10(abs(value))) + 1 - digits)
    found = finite_or_none(value, digits)
    assert abs(found - value) <= 0.5 * unit * (1.0 + 1e-9)
    assert found / unit == pytest.approx(round(value / unit), rel=1e-12)
