"""A test of many cases fails where one of them does, names it, and looks at the others."""

import pytest

from tests.each_case import each_case


def test_every_case_that_fails_is_named_and_the_others_are_looked_at():
    seen = []

    @each_case("number", [1, 2, 3, 4], ids=lambda number: f"the {number}")
    def is_odd(number, kept):
        kept.append(number)
        assert number % 2

    with pytest.raises(ExceptionGroup, match="2 of 4 cases") as failed:
        is_odd(kept=seen)
    assert seen == [1, 2, 3, 4]
    assert [one.__notes__ for one in failed.value.exceptions] == [["case: the 2"], ["case: the 4"]]


def test_a_test_without_a_case_fails():
    @each_case("number", [])
    def never(number):
        raise AssertionError(number)

    with pytest.raises(AssertionError, match="no case of number"):
        never()


def test_parts_of_a_case_go_to_their_names_and_each_meets_all_of_another():
    seen = []

    @each_case("sign", [1, -1])
    @each_case(("number", "text"), [(1, "one"), (2, "two")])
    def looked_at(number, text, sign):
        seen.append((sign * number, text))

    looked_at()
    assert seen == [(1, "one"), (2, "two"), (-1, "one"), (-2, "two")]
