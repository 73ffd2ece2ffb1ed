"""What a browser gets of a shot, read back as it reads it."""

from __future__ import annotations

import csv
import io
import json
import math
import struct
from typing import Any

import numpy as np
import pytest

from aff_hmi.scope.picture import encode, table, waiting
from aff_hmi.scope.shot import Shot, ShotRequest, shot_of
from aff_hmi.words import say_in
from tests.aff_hmi.scope.played import CYCLE_S, UTC_S, cut_of

T, EN = "unwind_tension_N", say_in("en")


def read(raw: bytes) -> tuple[Any, list[list[float]]]:
    """Read what ``encode`` wrote, as the page does."""
    (length,) = struct.unpack_from("<I", raw)
    assert (4 + length) % 8 == 0
    head, at = json.loads(raw[4 : 4 + length]), 4 + length
    columns = []
    for n in range(1 + len(head["signals"]) + head["turns"] if head["n"] > 0 else 0):
        size = 8 if n == 0 else 4
        kind = "d" if n == 0 else "f"
        columns.append(list(struct.unpack_from(f"<{head['n']}{kind}", raw, at)))
        at += size * head["n"]
    assert head["n"] <= 0 or at == len(raw)
    return head, columns


def test_a_shot_is_read_back_tick_by_tick() -> None:
    cut = cut_of(100, lambda n: math.nan if n == 50 else 0.5 * n)
    asked = ShotRequest(names=(T, "age_s"), roll="unwind", seconds=1)
    head, (times, tension, age, turns) = read(encode(Shot(cut=cut, at=7), asked, EN, "abc"))
    assert (head["n"], head["first"], head["last"], head["trigger_tick"]) == (100, 0, 99, 7)
    assert head["ring"] == "abc"
    assert head["utc_s"] == UTC_S
    assert times == pytest.approx([n * CYCLE_S for n in range(100)])
    assert math.isnan(tension[50])
    assert tension[51:] == [0.5 * n for n in range(51, 100)]
    assert age == pytest.approx([4.0] * 100)
    assert turns == pytest.approx([0.1 * n / (2.0 * math.pi) for n in range(100)], rel=1e-5)
    assert [one["unit"] for one in head["signals"]] == ["N", "ms"]
    assert len(head["orders"]) == 2


def test_missing_ticks_are_counted_and_changes_are_marked() -> None:
    cut = cut_of(100, float, state=lambda n: 3.0 if n < 40 else 0.0)
    keep = np.array([n for n in range(100) if not 60 <= n < 65])
    holed = type(cut)(
        ticks=cut.ticks[keep],
        time_s=cut.time_s[keep],
        states=cut.states[keep],
        values=cut.values[keep],
        signals=cut.signals,
        cycle_s=cut.cycle_s,
        utc_s=cut.utc_s,
    )
    head, _ = read(encode(Shot(cut=holed), ShotRequest(names=()), EN))
    assert head["missed"] == 5
    assert [one["at_s"] for one in head["marks"]] == [pytest.approx(40 * CYCLE_S)]


def test_nothing_is_told_of_no_ticks_and_of_a_trigger_that_waits() -> None:
    empty = shot_of(cut_of(0, float), ShotRequest(names=(T,)))
    assert empty is not None
    head, _ = read(encode(empty, ShotRequest(names=(T,)), EN))
    assert (head["n"], head["utc_s"]) == (0, None)
    head, _ = read(waiting())
    assert head["n"] == -1


def test_the_file_has_exactly_what_is_shown() -> None:
    shot = shot_of(cut_of(1000, float), ShotRequest(names=(T,), seconds=1, end=499))
    assert shot is not None
    text = io.StringIO()
    csv.writer(text).writerows(table(shot, ShotRequest(names=(T,), roll="unwind")))
    rows = list(csv.DictReader(io.StringIO(text.getvalue())))
    assert [int(one["tick"]) for one in rows] == list(range(300, 500))
    assert [float(one[f"{T} [N]"]) for one in rows] == list(range(300, 500))
    assert rows[0]["utc"].endswith("+00:00")
    assert float(rows[-1]["turns of unwind"]) == pytest.approx(19.9 / (2.0 * math.pi), rel=1e-4)
