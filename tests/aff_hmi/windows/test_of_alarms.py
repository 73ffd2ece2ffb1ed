"""The ticks around an alarm are kept by themselves, and are found from the alarm and the event."""

from __future__ import annotations

import asyncio
import json
from dataclasses import replace
from urllib.parse import parse_qs, urlparse

import pytest

pytest.importorskip("starlette")

from aff_hmi.see.alarm_part import AROUND_S
from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import State
from tests.aff_hmi.pressed import Pressed
from tests.aff_hmi.scope.played import CYCLE_S, news
from tests.aff_hmi.windows.test_scope_routes import play, raw, windows

AROUND = round(AROUND_S / CYCLE_S)
CODE = float(BY_NAME["PLC_STALE"].code)


def arrive(at: Pressed, first: int, count: int, *, alarm_at: int | None = None) -> None:
    """Have ticks arrive in the time that they take, and one of them bring an alarm."""
    assert at.hub.sources is not None
    for begin in range(first, first + count, 100):
        ticks = range(begin, min(begin + 100, first + count))
        at.clock.advance_ns(round(len(ticks) * CYCLE_S * 1e9))
        at.wall_s += len(ticks) * CYCLE_S
        told = news(ticks)
        if alarm_at in ticks:
            ago_ns = round((ticks[-1] - alarm_at) * CYCLE_S * 1e9)
            told = replace(told, events=[(alarm_at, at.clock.now_ns() - ago_ns, CODE, 0.0)])
        at.hub.sources.listen(told)
        stands = alarm_at is not None and ticks[-1] >= alarm_at
        at.show(State.FAULT if stands else State.ACTIVE, alarm=CODE if stands else 0.0)


def test_five_seconds_before_and_after_an_alarm_are_kept_once(keeping: Pressed) -> None:
    play(keeping, 1)
    arrive(keeping, 1, 1999)
    arrive(keeping, 2000, AROUND, alarm_at=2000)
    assert windows(keeping) == []  # the time after it is not over
    arrive(keeping, 2000 + AROUND, 400, alarm_at=2000)
    (one,) = windows(keeping)
    assert (one["first"], one["last"]) == (2000 - AROUND, 2000 + AROUND)
    assert one["seconds"] == pytest.approx(2 * AROUND_S)
    assert (one["name"], one["alarm"], one["who"]) == ("PLC_STALE", "PLC_STALE", "")
    arrive(keeping, 2400 + AROUND, 1000, alarm_at=2000)
    assert len(windows(keeping)) == 1


def test_of_a_control_process_that_ends_with_the_alarm_what_there_is_is_kept(
    keeping: Pressed,
) -> None:
    play(keeping, 1)
    arrive(keeping, 1, 1500)
    arrive(keeping, 1501, 20, alarm_at=1510)
    for _ in range(25):
        keeping.clock.advance_ns(500_000_000)
        keeping.wall_s += 0.5
        keeping.show(State.FAULT, alarm=CODE)
    (one,) = windows(keeping)
    assert (one["first"], one["last"]) == (1510 - AROUND, 1520)


def test_ticks_of_a_ring_of_the_same_numbers_are_not_taken_for_those_of_the_alarm(
    keeping: Pressed,
) -> None:
    """The service restarts at once after the alarm: its ticks begin at 1 again."""
    play(keeping, 1)
    arrive(keeping, 1, 1999)
    arrive(keeping, 2000, 10, alarm_at=2000)
    sources = keeping.hub.sources
    assert sources is not None
    sources.listen(news([], ring="two"))
    keeping.show(State.FAULT, alarm=CODE)
    for begin in range(1, 4000, 500):
        keeping.clock.advance_ns(2_500_000_000)
        keeping.wall_s += 2.5
        sources.listen(news(range(begin, begin + 500), ring="two"))
        keeping.show(State.FAULT, alarm=CODE)
    assert sources.scope.ticks.newest() > 2000
    assert windows(keeping) == []


def test_alarm_and_event_lead_to_the_ticks_of_the_window(keeping: Pressed) -> None:
    play(keeping, 1)
    arrive(keeping, 1, 1999)
    arrive(keeping, 2000, AROUND + 400, alarm_at=2000)
    assert keeping.kept is not None
    (alarm,) = json.loads(keeping.kept.part("alarms", "en"))["alarms"]
    events = json.loads(raw(keeping, "/data/events")[2])["events"]
    pages = {alarm["page"], *(e["page"] for e in events if e["name"] == "PLC_STALE")}
    (one,) = windows(keeping)
    for page in pages:
        asked = {name: float(value) for name, (value,) in parse_qs(urlparse(page).query).items()}
        assert one["first"] <= asked["tick"] <= one["last"]
        assert asked["end"] == one["last"]
        at_s = one["utc_s"] + (asked["tick"] - one["first"]) * CYCLE_S
        assert asked["at"] == pytest.approx(at_s, abs=0.02)
    cut = asyncio.run(keeping.hub.sources.windows.ticks(one["number"]))  # type: ignore[union-attr]
    assert cut is not None
    assert list(cut.of("unwind_tension_N")) == [float(n) for n in cut.ticks]  # as they were played
