"""A run of the bench that was stopped, or that failed late, has lost nothing that it measured."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from benchmarks.runtime.facts import FactRow
from benchmarks.screen.kept import Kept
from benchmarks.screen.ticks import Block

PLAN: dict[str, object] = {"rounds": 2}
BLOCK = Block(end_us=np.array([1.0, 2.5]), missed=1, screen_core=0.02, idle=3, idle_as="FADING 3")
ROW = FactRow(name="P6", value="14 ms", remark="target 60 ms")


def fails() -> list[FactRow]:
    raise RuntimeError("the\nline ended")


def test_what_was_measured_is_not_measured_again(tmp_path: Path) -> None:
    first = Kept(tmp_path, PLAN)
    assert first.block("00-alone", lambda: BLOCK) is not None
    assert first.rows("presses", lambda: [ROW]) == [ROW]
    again = Kept(tmp_path, PLAN)
    found = again.block("00-alone", lambda: Block(end_us=np.zeros(0), missed=0))
    assert found is not None
    assert found.end_us.tolist() == [1.0, 2.5]
    assert (found.missed, found.screen_core, found.idle) == (1, 0.02, 3)
    assert found.idle_as == "FADING 3"
    assert math.isnan(found.frames_per_s)
    assert again.rows("presses", fails) == [ROW]
    assert again.failed == {}


def test_a_part_that_fails_is_told_and_measured_the_next_time(tmp_path: Path) -> None:
    kept = Kept(tmp_path, PLAN)
    (row,) = kept.rows("breaks", fails)
    assert (row.value, row.remark) == ("not measured", "RuntimeError: the line ended")
    assert list(kept.failed) == ["breaks"]
    assert Kept(tmp_path, PLAN).rows("breaks", lambda: [ROW]) == [ROW]


def test_what_is_of_another_plan_is_dropped(tmp_path: Path) -> None:
    Kept(tmp_path, PLAN).rows("presses", lambda: [ROW])
    other = Kept(tmp_path, {"rounds": 6})
    assert other.rows("presses", fails)[0].value == "not measured"
    other.drop()
    assert not tmp_path.exists()
