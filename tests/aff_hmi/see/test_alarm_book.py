"""The life of an alarm: it comes, somebody sees it, it is over; what is not known ends nothing."""

from __future__ import annotations

from dataclasses import replace

import pytest

from aff_hmi.condition import Condition
from aff_hmi.see.alarm import Follower, Leader, Life
from aff_hmi.see.alarm_book import FLOOD, MOST, MOST_EVENTS, AlarmBook, Refusal
from aff_runtime.base.events import BY_NAME
from tests.doubles.virtual_clock import VirtualClock

S = 1_000_000_000
STALE = Condition(
    key="PLC_STALE", rank=2, name="PLC_STALE", text="t", to_do="d", code=BY_NAME["PLC_STALE"].code
)
ROSE = replace(STALE, key="RIPPLE_ROSE", rank=1, code=BY_NAME["RIPPLE_ROSE"].code)
REST = Condition(key="rest", rank=3, name="unwind", text="t", to_do="d", delay_s=60.0)


class Told:
    """A book, its clock and a wall clock that runs with it."""

    def __init__(self, *, can_be_seen: bool = True) -> None:
        self.clock = VirtualClock(1)
        self.clock.sleep_until_ns(1000 * S)
        self.book = AlarmBook(
            self.clock, lambda: 5000.0 + self.clock.now_ns() / S, can_be_seen=can_be_seen
        )

    def look(
        self,
        *conditions: Condition,
        after_s: float = 0.5,
        is_known: bool = True,
        is_active: bool = False,
    ) -> None:
        self.clock.advance_ns(round(after_s * S))
        self.book.look(conditions, is_known=is_known, is_active=is_active)

    def hear(self, name: str, tick: float) -> None:
        """Have the ring tell an event of this moment."""
        self.book.hear([(tick, self.clock.now_ns(), float(BY_NAME[name].code), 0.0)])

    @property
    def lives(self) -> list[tuple[str, str]]:
        return [(one.condition.key, one.life) for one in self.book.shown()]


@pytest.fixture
def told() -> Told:
    return Told()


def test_an_alarm_goes_from_active_to_seen_to_away(told: Told) -> None:
    told.look(STALE)
    assert told.lives == [("PLC_STALE", Life.ACTIVE)]
    assert told.book.acknowledge("PLC_STALE", "anna") is None
    told.look(STALE)
    assert told.lives == [("PLC_STALE", Life.SEEN)]
    assert told.book.shown()[0].seen_by == "anna"
    told.look()
    assert told.lives == []


def test_what_is_over_stays_until_somebody_has_seen_it(told: Told) -> None:
    told.look(STALE)
    told.look()
    told.look(after_s=3600.0)
    assert told.lives == [("PLC_STALE", Life.GONE)]
    assert told.book.acknowledge("PLC_STALE", "anna") is None
    assert told.lives == []


def test_where_nobody_can_say_so_it_leaves_by_itself() -> None:
    told = Told(can_be_seen=False)
    told.look(STALE)
    told.look()
    assert told.lives == []


def test_the_signal_that_was_named_stays_named_when_its_cause_is_over(told: Told) -> None:
    told.look(replace(STALE, name="PLC_STALE (unwind_tension_N)"))
    told.look(STALE)  # the latch stands, the guard names no signal any more
    assert told.book.shown()[0].condition.name == "PLC_STALE (unwind_tension_N)"
    told.look(replace(STALE, name="PLC_STALE (line_speed_m_s)"))
    assert told.book.shown()[0].condition.name == "PLC_STALE (line_speed_m_s)"


def test_only_what_has_waited_for_its_delay_stands(told: Told) -> None:
    told.look(REST, STALE)
    assert told.book.standing == {"PLC_STALE": "PLC_STALE"}
    told.look(REST, after_s=60.0)
    assert told.book.standing == {"rest": "unwind"}


def test_nothing_is_over_while_the_service_is_not_heard(told: Told) -> None:
    told.look(STALE)
    told.look(is_known=False)
    assert told.lives == [("PLC_STALE", Life.ACTIVE)]
    told.look()
    assert told.lives == [("PLC_STALE", Life.GONE)]


def test_what_comes_and_goes_within_its_minute_is_no_alarm(told: Told) -> None:
    told.look(REST)
    told.look(REST, after_s=59.0)
    assert told.lives == []
    told.look()
    told.look(REST, after_s=59.0)
    assert told.lives == []
    told.look(REST, after_s=60.0)
    assert told.lives == [("rest", Life.ACTIVE)]
    assert told.book.shown()[0].since_s == pytest.approx(5000.0 + told.clock.now_ns() / S - 60.0)


def test_it_is_dated_by_its_event_and_not_by_when_we_looked(told: Told) -> None:
    now_ns = told.clock.now_ns()
    told.book.hear([(4711.0, now_ns - 3 * S, float(STALE.code), 0.0)])
    told.look(STALE, after_s=0.0)
    (alarm,) = told.book.shown()
    assert alarm.tick == 4711
    assert alarm.since_s == pytest.approx(5000.0 + now_ns / S - 3.0)


def test_first_out_names_what_came_with_it_and_how_much_later(told: Told) -> None:
    now_ns = told.clock.now_ns()
    names = ("OVERRUN", "PLC_STALE", "TENSION_IMPLAUSIBLE", "BYPASSED", "SIGNAL_IMPLAUSIBLE")
    at_s = (-1.0, 0.0, 0.035, 0.5, 2.5)
    told.book.hear(
        [
            (1.0, now_ns + round(t * S), float(BY_NAME[n].code), 0.0)
            for n, t in zip(names, at_s, strict=True)
        ]
    )
    told.look(STALE, after_s=3.0)
    (alarm,) = told.book.shown()
    assert alarm.is_first
    assert [(f.name, pytest.approx(f.after_s)) for f in alarm.followers] == [
        ("TENSION_IMPLAUSIBLE", 0.035)
    ]
    assert isinstance(alarm.followers[0], Follower)


def test_first_out_is_settled_once_and_a_flood_takes_nothing_of_it_away(told: Told) -> None:
    now_ns, implausible = told.clock.now_ns(), BY_NAME["TENSION_IMPLAUSIBLE"].code
    told.book.hear([(7.0, now_ns, float(STALE.code), 0.0)])
    told.book.hear([(9.0, now_ns + S // 100, float(implausible), 0.0)])
    told.look(STALE, after_s=1.9)
    assert told.book.settled() == []
    told.look(STALE, after_s=0.2)
    (alarm,) = told.book.settled()
    before = [(f.name, f.after_s) for f in alarm.followers]
    assert before == [("TENSION_IMPLAUSIBLE", pytest.approx(0.01))]
    splice = float(BY_NAME["SPLICE"].code)
    told.book.hear([(float(n), now_ns + 3 * S, splice, 0.0) for n in range(MOST_EVENTS)])
    told.look(STALE)
    assert told.book.settled() == []
    assert [(f.name, f.after_s) for f in told.book.shown()[0].followers] == before


@pytest.mark.parametrize("ago_s", [0.3, 1.5, 30.0])
@pytest.mark.parametrize("name", ["PERMISSIVE_LOST", "SPLICE", "BYPASSED"])
def test_what_had_taken_the_correction_out_before_leads_and_the_alarm_is_not_first(
    told: Told, name: str, ago_s: float
) -> None:
    told.look(is_active=True)
    told.hear(name, 4700.0)
    told.look(after_s=ago_s)
    told.hear("PLC_STALE", 4711.0)
    told.look(STALE, after_s=0.1)
    (alarm,) = told.book.shown()
    assert alarm.led_by == Leader(name=name, before_s=pytest.approx(ago_s), tick=4700)


def test_a_permissive_that_came_back_before_leads_nothing(told: Told) -> None:
    told.look(is_active=True)
    told.hear("PERMISSIVE_LOST", 4700.0)
    told.look(is_active=True, after_s=0.5)  # a look may still show what has begun to fade
    told.look(after_s=1.0)
    told.look(is_active=True, after_s=3.0)
    told.hear("PLC_STALE", 4711.0)
    told.look(STALE, after_s=0.1)
    (alarm,) = told.book.shown()
    assert (alarm.is_first, alarm.led_by) == (True, None)


def test_only_a_high_alarm_that_stands_and_nobody_has_seen_is_loud(told: Told) -> None:
    told.look(STALE, REST)
    assert not told.book.is_loud
    told.look(STALE, ROSE)
    assert told.book.is_loud
    told.book.acknowledge("RIPPLE_ROSE", "anna")
    assert not told.book.is_loud
    told.look(STALE)
    told.look(STALE, ROSE)
    assert told.book.is_loud  # here again: seen before is not seen now
    told.look(STALE)
    assert not told.book.is_loud  # over


def test_what_comes_again_within_a_minute_is_one_line_with_a_count(told: Told) -> None:
    for _ in range(3):
        told.look(STALE)
        told.look()
    assert [(a.times, a.life) for a in told.book.shown()] == [(3, Life.GONE)]
    told.book.acknowledge("PLC_STALE", "anna")
    told.look(STALE, after_s=30.0)
    assert told.book.shown()[0].times == 4
    assert told.book.shown()[0].life is Life.ACTIVE  # seen before is not seen now
    told.book.acknowledge("PLC_STALE", "anna")
    told.look()
    told.look(after_s=61.0)
    told.look(STALE)
    assert told.book.shown()[0].times == 1


def test_put_aside_for_a_while_with_a_reason(told: Told) -> None:
    told.look(STALE)
    assert told.book.shelve("PLC_STALE", "anna", 30, "cable ordered") is None
    told.look(STALE, after_s=29 * 60.0)
    assert told.lives == [("PLC_STALE", Life.SHELVED)]
    told.look(after_s=1.0)
    told.look(STALE, after_s=1.0)
    assert told.lives == [("PLC_STALE", Life.SHELVED)]  # gone and back: still put aside
    told.look(STALE, after_s=60.0)
    assert told.lives == [("PLC_STALE", Life.ACTIVE)]


def test_no_longer_than_eight_hours_and_taken_back_at_any_time(told: Told) -> None:
    told.look(STALE)
    told.book.shelve("PLC_STALE", "anna", 10_000, "cable ordered")
    told.look(STALE, after_s=8 * 3600.0 - 1.0)
    assert told.lives == [("PLC_STALE", Life.SHELVED)]
    told.look(STALE, after_s=1.0)
    assert told.lives == [("PLC_STALE", Life.ACTIVE)]
    told.book.shelve("PLC_STALE", "anna", 30, "cable ordered")
    told.book.shelve("PLC_STALE", "anna", 0, "")
    assert told.lives == [("PLC_STALE", Life.ACTIVE)]


def test_high_priority_is_never_put_aside_and_what_is_not_there_is_said(told: Told) -> None:
    told.look(ROSE)
    assert told.book.shelve("RIPPLE_ROSE", "anna", 30, "known") is Refusal.HIGH
    assert told.book.shelve("nothing", "anna", 30, "known") is Refusal.UNKNOWN
    assert told.book.acknowledge("nothing", "anna") is Refusal.UNKNOWN
    assert told.lives == [("RIPPLE_ROSE", Life.ACTIVE)]


def test_the_most_urgent_stands_first_and_what_is_over_behind(told: Told) -> None:
    rest = replace(REST, delay_s=0.0)
    told.look(rest)
    told.look(rest, STALE)
    told.look(rest, STALE, ROSE)
    assert [key for key, _ in told.lives] == ["RIPPLE_ROSE", "PLC_STALE", "rest"]
    told.look(rest, STALE)
    assert [key for key, _ in told.lives] == ["PLC_STALE", "rest", "RIPPLE_ROSE"]


def test_a_flood_is_counted_and_the_book_stays_small(told: Told) -> None:
    for n in range(FLOOD):
        told.look(replace(STALE, key=str(n)))
    assert not told.book.load().is_flood
    for n in range(2 * MOST):
        told.look(replace(STALE, key=f"more {n}"))
    load = told.book.load()
    assert load.is_flood
    assert load.day == (0, FLOOD + 2 * MOST, 0)
    assert len(told.lives) == MOST
    told.look(after_s=601.0)
    assert told.book.load().ten_minutes == 0
