"""A short fixed run of every target; ``make fuzz`` is the long one."""

from __future__ import annotations

from collections import Counter

import pytest

from tests.fuzz.source import Source, mutations
from tests.fuzz.targets import TARGETS

RUNS = {"canopen": 12, "eds_text": 12, "dbc_text": 40, "can_ticks": 40, "site_file": 40}
ALWAYS_TRUE = {"modbus_words", "can_command", "can_ticks"}  # any bytes are a use of these


@pytest.mark.parametrize("name", TARGETS)
def test_no_input_breaks_it_and_true_ones_are_still_taken(name: str) -> None:
    target = TARGETS[name]
    became = Counter(target.run(data) for data in mutations(target.seeds, RUNS.get(name, 100), 11))
    assert became[target.good] > 0
    assert became["refused without a word"] == 0
    if name not in ALWAYS_TRUE:
        assert len(became) > 1, "nothing was ever refused"


def test_the_same_seed_makes_the_same_inputs() -> None:
    assert mutations([b"abc"], 50, 4) == mutations([b"abc"], 50, 4)
    assert mutations([b"abc"], 50, 4) != mutations([b"abc"], 50, 5)


def test_an_empty_source_decides_for_zero() -> None:
    source = Source(b"")
    assert (source.byte(), source.word(), source.below(7), source.take(3)) == (0, 0, 0, b"")
    assert source.spoilt(b"good") == b"good"
    assert not source
