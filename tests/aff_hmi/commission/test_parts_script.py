"""Parts of a proof by hand are counted with fresh data alone."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from tests.aff_hmi.scripts import called

PLAY = """
const parts = [];
for (const one of given) one === null ? of.cut(parts) : of.take(parts, one, 700);
const found = parts.map((one) => [one.word, of.secondsOf(one)]);
"""


def parts_of(folder: Path, *seen: Any) -> Any:
    """Return word and seconds of each part; ``seen`` : (ms, whether on), None for a break."""
    words = {True: "ACTIVE", False: "BYPASS"}
    given = [
        None if one is None else {"now": one[0], "isOn": one[1], "word": words[one[1]]}
        for one in seen
    ]
    return called(folder, "parts", "found", *given, before=PLAY)


def test_a_part_goes_from_its_first_fresh_frame_to_its_last(tmp_path: Path) -> None:
    on = [(100 * n, True) for n in range(31)]
    off = [(3100 + 100 * n, False) for n in range(11)]
    assert parts_of(tmp_path, *on, *off) == [["ACTIVE", 3.0], ["BYPASS", 1.0]]


def test_a_break_ends_a_part_at_its_last_fresh_frame_and_a_new_one_begins(tmp_path: Path) -> None:
    before = [(100 * n, True) for n in range(11)]
    after = [(60_000 + 100 * n, True) for n in range(21)]
    assert parts_of(tmp_path, *before, *after) == [["ACTIVE", 1.0], ["ACTIVE", 2.0]]
    soon = [(1300 + 100 * n, True) for n in range(21)]
    assert parts_of(tmp_path, *before, *soon) == [["ACTIVE", 3.3]]
    assert parts_of(tmp_path, *before, None, None, *soon) == [["ACTIVE", 1.0], ["ACTIVE", 2.0]]


def test_a_break_before_the_first_part_is_none(tmp_path: Path) -> None:
    assert parts_of(tmp_path, None, (5, False)) == [["BYPASS", 0.0]]
