"""Every tick of ten minutes is there, in the units of the screen, and no more than that."""

from __future__ import annotations

import numpy as np
import pytest

from aff_hmi.scope.signals import MOST, signal_of, signals_of
from aff_hmi.scope.ticks import KEPT_S, MOST_TICKS, Ticks
from aff_hmi.words import say_in
from tests.aff_hmi.moments import LINE
from tests.aff_hmi.scope.played import COLUMNS, CYCLE_S, SIGNALS, UTC_S, record
from tests.each_case import each_case


def begun(cycle_s: float = CYCLE_S) -> Ticks:
    ticks = Ticks(lambda: UTC_S)
    ticks.begin("one", COLUMNS, SIGNALS, cycle_s)
    return ticks


def test_what_arrives_is_there_in_order_with_its_wall_time() -> None:
    ticks = begun()
    for first in range(0, 100, 10):
        ticks.add([record(n) for n in range(first, first + 10)])
    cut = ticks.cut()
    assert cut.ticks.tolist() == list(range(100))
    assert cut.of("unwind_tension_N").tolist() == list(range(100))
    assert cut.utc_s + cut.time_s[-1] == UTC_S
    assert ticks.newest() == 99


def test_the_oldest_go_after_ten_minutes_and_the_newest_never() -> None:
    ticks = begun()
    size = round(KEPT_S / CYCLE_S)
    ticks.add([record(n) for n in range(size)])
    ticks.add([record(n) for n in range(size, size + 7)])
    cut = ticks.cut()
    assert (len(cut), cut.ticks[0], cut.ticks[-1]) == (size, 7, size + 6)
    assert np.all(np.diff(cut.ticks) == 1)


def test_a_quick_cycle_costs_no_more_memory() -> None:
    ticks = begun(1e-4)
    assert len(ticks._head) == MOST_TICKS


@each_case(
    ("since", "most", "found"),
    [
        (40, 5, [40, 41, 42, 43, 44]),
        (98, 5, [98, 99]),
        (200, 5, []),
        (-1, 2, [0, 1]),
        (52, 1, [54]),
    ],
)
def test_a_part_is_found_by_tick_numbers_where_some_are_missing(
    since: int, most: int, found: list[int]
) -> None:
    ticks = begun()
    ticks.add([record(n) for n in range(100) if not 50 <= n < 54])
    assert ticks.cut(since, most).ticks.tolist() == found


def test_units_are_those_of_the_screen() -> None:
    ticks = begun()
    ticks.add([record(1)])
    cut = ticks.cut()
    said = {one.name: (one.unit, float(cut.of(one.name)[0])) for one in cut.signals}
    assert said["line_speed_m_s"] == ("m/min", 60.0)
    assert said["correction_unwind_m_s"] == ("mm/s", pytest.approx(2.0))
    assert said["age_s"] == ("ms", pytest.approx(4.0))
    assert said["tick_us"] == ("ms", pytest.approx(0.9))
    assert said["unwind.theta_rad"] == ("deg", pytest.approx(0.1 * 180.0 / np.pi))


def test_another_ring_begins_anew_and_has_another_name() -> None:
    ticks = begun()
    ticks.add([record(1)])
    before = ticks.ident
    ticks.begin("two", COLUMNS, SIGNALS, CYCLE_S)
    assert len(ticks.cut()) == 0
    assert ticks.newest() == -1
    assert ticks.ident != before
    assert not ticks.is_of("one", COLUMNS)
    assert ticks.is_of("two", COLUMNS)


def test_signals_are_few_and_what_is_measured_comes_first() -> None:
    columns = (*COLUMNS, *(f"extra{n}_N" for n in range(100)))
    found = signals_of(columns, LINE)
    assert len(found) == MOST
    names = [one.name for one in found]
    assert names[0] == "unwind_tension_N"
    assert {"correction_unwind_m_s", "unwind.theta_rad", "tick_us"} <= set(names)


def test_a_signal_is_told_in_the_readers_language_with_the_sites_own_name() -> None:
    one = signal_of("correction_unwind_m_s", LINE)
    assert one.words(say_in("en")) == "unwind: correction"
    assert one.words(say_in("de")) == "unwind: Korrektur"
    hostile = signal_of("<b>{x}\u202e_tension_N", LINE)
    assert "\u202e" not in hostile.words(say_in("de"))
