"""Single values of a site file's text: replaced where they stand, or refused."""

from __future__ import annotations

import pytest
import yaml

from aff_runtime.base.errors import ConfigError, RefusedError
from aff_runtime.config.edited_text import EditedText
from tests.each_case import each_case

TEXT = """\
# of the line
line: { name: "Euclid", cycle_ms: 5 } # five
base: &base { settle_s: 6, orders: [1, 2] }
one: *base
two:
  <<: *base
  limit: 300 FPM   # of the plant
  names: [a, 'b']
  lines:
    - 1
    - 2
  text: >
    folded
"""


@each_case(
    ("path", "written"),
    [
        (("line", "name"), "Euclid"),
        (("line", "cycle_ms"), "5"),
        (("two", "limit"), "300 FPM"),
        (("two", "lines", 1), "2"),
        (("two", "lines"), None),
        (("two", "text"), None),
        (("two", "names"), None),
        (("line",), None),
        (("nowhere",), None),
    ],
)
def test_what_stands_there_is_one_value_in_one_line_or_nothing(path, written) -> None:
    assert EditedText(TEXT).written(path) == written


@pytest.mark.parametrize("path", [("base", "settle_s"), ("one", "settle_s"), ("two", "orders")])
def test_what_several_places_share_is_left_alone(path) -> None:
    assert EditedText(TEXT).written(path) is None
    with pytest.raises(ConfigError, match="write it into the site file first"):
        EditedText(TEXT).with_values({path: "7"})


def test_a_value_is_replaced_and_no_other_byte() -> None:
    changed = EditedText(TEXT).with_values(
        {("two", "limit"): "200 FPM", ("line", "name"): "other", ("line", "cycle_ms"): "10"}
    )
    wanted = TEXT.replace("300 FPM", "200 FPM").replace('"Euclid"', '"other"')
    assert changed == wanted.replace("cycle_ms: 5", "cycle_ms: 10")
    assert yaml.safe_load(changed)["line"] == {"name": "other", "cycle_ms": 10}


def test_a_list_in_one_line_is_one_value() -> None:
    text = "a:\n  - { orders: [1, 2], x: 1 }  # two\n"
    path = ("a", 0, "orders")
    assert EditedText(text).written(path) == "[1, 2]"
    assert EditedText(text).with_values({path: "[1, 2, 12]"}) == text.replace(
        "[1, 2]", "[1, 2, 12]"
    )
    with pytest.raises(RefusedError, match="a list such as"):
        EditedText(text).with_values({path: "3"})


@each_case(
    "new", ["", " ", "1, x: 2", "5 # five", "&a 5", "[1]", "{a: 1}", "5\nline: 6", "'", "x" * 81]
)
def test_what_is_no_single_value_is_not_written(new) -> None:
    with pytest.raises(RefusedError, match="one value, such as"):
        EditedText(TEXT).with_values({("line", "cycle_ms"): new})


def test_a_decimal_comma_is_told_as_one() -> None:
    with pytest.raises(RefusedError, match="a point, not a comma"):
        EditedText(TEXT).with_values({("line", "cycle_ms"): "0,5"})
