"""Files of tests are begun in an order that keeps two cores at work."""

from pathlib import Path

from tests.conftest import LONGEST_FIRST
from tests.one_waits import WAITING, OneWaits

TESTS = Path(__file__).parents[1]
MADE = object.__new__(OneWaits)  # of a session there is nothing in what is asked here


def test_every_file_that_comes_first_is_there_and_comes_once():
    first = (*WAITING, *LONGEST_FIRST)
    assert [name for name in first if not (TESTS / name).is_file()] == []
    assert len(set(first)) == len(first)


def test_what_waits_goes_to_one_worker_and_any_other_file_is_its_own():
    def given(name):
        return MADE._split_scope(f"tests/{name}::test_it[a::b]")

    assert len({given(name) for name in WAITING}) == 1
    assert given("house/test_links.py") == "tests/house/test_links.py"


def test_what_is_left_of_a_worker_is_counted_through_unfinished_files():
    done, half, new = {"a": True}, {"b": True, "c": False}, {"d": False, "e": False}
    assert MADE._pending_of({"1": done, "2": half, "3": new}) == 3
    assert MADE._pending_of({"1": done}) == 0
