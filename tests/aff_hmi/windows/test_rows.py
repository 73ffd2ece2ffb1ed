"""Kept windows: nothing pushes one out but a person, and they have a bound of their own."""

from __future__ import annotations

import sqlite3
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from aff_hmi.see import events
from aff_hmi.see.store import Store
from aff_hmi.see.trend_rows import SCHEMA as TREND_SCHEMA
from aff_hmi.see.trend_rows import prune_trend
from aff_hmi.windows.rows import (
    MOST,
    MOST_OF_ALARMS,
    FullError,
    Window,
    begin,
    delete,
    keep,
    keep_of_alarm,
    listed,
    packed,
    ticks_of,
    unpacked,
)
from tests.aff_hmi.scope.played import cut_of

SAID = Window(
    name="a splice",
    note="second shift",
    who="anna",
    utc_s=1.8e9,
    seconds=1.0,
    first=0,
    last=199,
    run="20260101-000000",
    config="3f9a3f9a",
    line="Euclid",
)
BOUND = 10_000_000


@pytest.fixture
def table() -> sqlite3.Connection:
    connection = sqlite3.connect(":memory:")
    begin(connection)
    return connection


def test_a_window_comes_back_bit_by_bit(table: sqlite3.Connection) -> None:
    cut = cut_of(200, lambda n: float("nan") if n == 3 else n / 7.0)
    number = keep(table, SAID, cut, BOUND)
    found = ticks_of(table, number)
    assert found is not None
    for name in ("ticks", "time_s", "states", "values"):
        assert np.array_equal(getattr(found, name), getattr(cut, name), equal_nan=True)
    assert (found.signals, found.cycle_s, found.utc_s) == (cut.signals, cut.cycle_s, cut.utc_s)
    assert unpacked(*packed(cut)).events == cut.events
    (said,) = listed(table)
    assert (said.name, said.note, said.who, said.number) == ("a splice", "second shift", "anna", 1)
    assert said.size > 0


def test_a_full_share_refuses_and_lets_go_of_nothing(table: sqlite3.Connection) -> None:
    cut = cut_of(200, float)
    size = len(packed(cut)[1])
    keep(table, SAID, cut, 2 * size)
    keep(table, SAID, cut, 2 * size)
    with pytest.raises(FullError):
        keep(table, SAID, cut, 2 * size)
    assert len(listed(table)) == 2
    assert delete(table, 1) == "a splice"
    assert keep(table, SAID, cut, 2 * size) == 3  # a number is never used again


def test_there_are_at_most_so_many(table: sqlite3.Connection) -> None:
    cut = cut_of(2, float)
    for _ in range(MOST):
        keep(table, SAID, cut, BOUND)
    with pytest.raises(FullError):
        keep(table, SAID, cut, BOUND)


def test_windows_of_alarms_make_room_for_each_other_and_for_nothing_else(
    table: sqlite3.Connection,
) -> None:
    cut = cut_of(200, float)
    own = keep(table, SAID, cut, BOUND)
    for n in range(MOST_OF_ALARMS + 3):
        keep_of_alarm(table, replace(SAID, who="", alarm=f"A{n}"), cut, BOUND)
    found = listed(table)
    assert [one.alarm for one in found[:-1]] == [f"A{n}" for n in range(MOST_OF_ALARMS + 2, 2, -1)]
    assert (found[-1].number, found[-1].alarm) == (own, "")
    size = found[0].size
    keep_of_alarm(table, replace(SAID, alarm="last"), cut, 3 * size + size // 2)
    assert listed(table)[0].alarm == "last"
    assert len(listed(table)) == 1 + 3
    keep_of_alarm(table, replace(SAID, alarm="too large"), cut, size - 1)
    assert [one.alarm for one in listed(table)] == [""]
    keep(table, SAID, cut, 2 * size)  # what alarms take is not counted against a person
    with pytest.raises(FullError):
        keep(table, SAID, cut, 2 * size)


def test_what_is_not_there_is_said(table: sqlite3.Connection) -> None:
    assert ticks_of(table, 7) is None
    assert delete(table, 7) == ""


def test_a_window_outlives_a_year_a_full_store_and_a_restart(tmp_path: Path) -> None:
    schema = (*events.SCHEMA, *TREND_SCHEMA)
    store = Store(tmp_path, schema)
    store.put(begin)
    store.now(lambda c: keep(c, SAID, cut_of(200, float), BOUND))
    later_s = SAID.utc_s + 20 * 366 * 86_400.0
    store.now(lambda c: events.prune(c, later_s, is_full=True))
    store.now(lambda c: prune_trend(c, later_s, is_full=True))
    store.close()
    again = Store(tmp_path, schema)
    again.put(begin)
    assert [one.name for one in again.now(listed)] == ["a splice"]
    again.close()
