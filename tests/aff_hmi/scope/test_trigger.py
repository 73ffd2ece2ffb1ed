"""A trigger fires where the formula says, and at no hole."""

from __future__ import annotations

import math

from aff_hmi.scope.shot import ShotRequest, asked_of, shot_of
from aff_hmi.scope.ticks import Ticks
from aff_hmi.scope.trigger import On, Trigger, places
from aff_runtime.base.events import BY_NAME
from tests.aff_hmi.scope.played import COLUMNS, CYCLE_S, SIGNALS, cut_of, record
from tests.each_case import each_case

T = "unwind_tension_N"


def at(on: On, level: float = 0.0) -> Trigger:
    return Trigger(on=on, signal=T, level=level)


def test_edges_of_a_sine_lie_one_period_apart() -> None:
    cut = cut_of(1000, lambda n: math.sin(2.0 * math.pi * (n - 10.5) / 100.0))
    assert places(cut, at(On.RISE)).tolist() == [11 + 100 * k for k in range(10)]
    assert places(cut, at(On.FALL)).tolist() == [61 + 100 * k for k in range(10)]


def test_a_level_holds_at_every_tick_beyond_it() -> None:
    cut = cut_of(10, float)
    assert places(cut, at(On.ABOVE, 7.0)).tolist() == [7, 8, 9]
    assert places(cut, at(On.BELOW, 2.0)).tolist() == [0, 1, 2]


def test_a_hole_is_no_edge() -> None:
    cut = cut_of(10, lambda n: math.nan if n == 5 else (0.0 if n < 5 else 1.0))
    assert places(cut, at(On.RISE, 0.5)).tolist() == []
    ticks = Ticks(lambda: 0.0)
    ticks.begin("one", COLUMNS, SIGNALS, CYCLE_S)
    ticks.add([record(n) for n in (1, 2, 8, 9)])
    assert places(ticks.cut(), at(On.RISE, 5.0)).tolist() == []


def test_a_change_of_state_and_events_fire() -> None:
    cut = cut_of(10, float, state=lambda n: 3.0 if n < 6 else 0.0)
    assert places(cut, Trigger(on=On.STATE)).tolist() == [6]
    ticks = Ticks(lambda: 0.0)
    ticks.begin("one", COLUMNS, SIGNALS, CYCLE_S)
    splice, stale = BY_NAME["SPLICE"].code, BY_NAME["PLC_STALE"].code
    ticks.add([record(n) for n in range(10)], [(3, 0, splice, 0), (7, 0, stale, 0)])
    assert places(ticks.cut(), Trigger(on=On.EVENT)).tolist() == [3, 7]
    assert places(ticks.cut(), Trigger(on=On.FIRST_OUT)).tolist() == [7]


@each_case(("pre", "first"), [(0, 500), (20, 460), (50, 400), (80, 340), (100, 301)])
def test_a_shot_lies_around_its_trigger(pre: int, first: int) -> None:
    cut = cut_of(1000, float)
    asked = ShotRequest(names=(T,), seconds=1, trigger=at(On.RISE, 500.0), pre_percent=pre)
    shot = shot_of(cut, asked)
    assert shot is not None
    assert shot.at is not None
    assert len(shot.cut) == 200
    assert shot.cut.ticks[0] == first
    assert shot.cut.ticks[shot.at] == 500


def test_a_shot_that_is_not_whole_yet_is_waited_for() -> None:
    asked = ShotRequest(names=(T,), seconds=1, trigger=at(On.RISE, 500.0), pre_percent=20)
    assert shot_of(cut_of(600, float), asked) is None
    assert shot_of(cut_of(660, float), asked) is not None


def test_a_trigger_counts_after_a_tick() -> None:
    cut = cut_of(1000, lambda n: float(n % 100))
    asked = ShotRequest(
        names=(T,), seconds=1, trigger=at(On.RISE, 50.0), after=250, pre_percent=20
    )
    shot = shot_of(cut, asked)
    assert shot is not None
    assert shot.at is not None
    assert shot.cut.ticks[shot.at] == 350


def test_without_a_trigger_it_ends_where_it_is_asked_to() -> None:
    cut = cut_of(1000, float)
    assert shot_of(cut, ShotRequest(names=(T,), seconds=1)).cut.ticks[-1] == 999  # type: ignore[union-attr]
    found = shot_of(cut, ShotRequest(names=(T,), seconds=2, end=700))
    assert found is not None
    assert (found.cut.ticks[0], found.cut.ticks[-1]) == (301, 700)


@each_case(
    "query",
    [
        {"seconds": "3"},
        {"seconds": "-1"},
        {"seconds": "5" * 100},
        {"seconds": "٥"},
        {"signals": ",".join(f"s{n}" for n in range(9))},
        {"signals": "a,a"},
        {"signals": "a" * 101},
        {"roll": "a" * 101},
        {"of": "a" * 101},
        {"on": "sometimes"},
        {"level": "nan"},
        {"level": "inf"},
        {"level": "1e999"},
        {"level": "1" * 31},
        {"pre": "33"},
        {"end": "1.5"},
        {"after": "x"},
        {"kept": "../../etc"},
    ],
    ids=str,
)
def test_what_is_no_request_of_ours_is_none(query: dict[str, str]) -> None:
    assert asked_of(query) is None


def test_a_right_request_is_read() -> None:
    said = {"signals": f"{T},age_s", "seconds": "10", "on": "rise", "of": T, "level": "-1.5"}
    assert asked_of(said | {"after": "7", "pre": "50", "roll": "unwind"}) == ShotRequest(
        names=(T, "age_s"),
        seconds=10,
        roll="unwind",
        trigger=Trigger(on=On.RISE, signal=T, level=-1.5),
        after=7,
        pre_percent=50,
    )
