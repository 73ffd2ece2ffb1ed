"""What happens on a line is written down once, with its time, kind and roll."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import pytest

from aff_hmi.see.events import SCHEMA, KeptEvent, Wanted, select
from aff_hmi.see.journal import Journal
from aff_hmi.see.store import Store
from aff_hmi.watch import News, Observed
from aff_runtime.app.report.status_answer import OperatorNote
from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import State
from aff_runtime.core.monitor import OrderState
from tests.aff_hmi.moments import facts, row, seen
from tests.doubles.virtual_clock import VirtualClock

S = 1_000_000_000
WALL_S = 1.8e9
COLUMNS = ("time_s", "tick", "state", "roll_id")


class Told:
    def __init__(self) -> None:
        self.store = Store(None, SCHEMA)
        self.clock = VirtualClock(1)
        self.clock.sleep_until_ns(1000 * S)
        self.journal = self.begun()

    def begun(self) -> Journal:
        return Journal(self.store, self.clock, lambda: WALL_S)

    def look(self, moment: Observed | None = None, *, after_s: float = 0.5) -> None:
        self.clock.advance_ns(round(after_s * S))
        self.journal.look(seen() if moment is None else moment)

    def ticks(self, *rows: tuple[float, ...]) -> None:
        self.journal.listen(News(ring="r", columns=COLUMNS, records=rows))
        self.look()

    def said(self, **wanted: str) -> list[KeptEvent]:
        """Return what is kept, the oldest first."""
        return self.store.now(lambda c: select(c, Wanted(**wanted)))[::-1]  # type: ignore[arg-type]

    @property
    def names(self) -> list[str]:
        return [one.name for one in self.said()]


@pytest.fixture
def told() -> Iterator[Told]:
    found = Told()
    yield found
    found.store.close()


def of_ring(told: Told, name: str, ago_s: float) -> tuple[float, ...]:
    return (42.0, told.clock.now_ns() - ago_s * S, float(BY_NAME[name].code), 0.0)


def test_an_event_of_the_ring_has_its_own_time_tick_and_kind(told: Told) -> None:
    names = ("PLC_STALE", "SPLICE", "BYPASSED")
    events = [of_ring(told, name, 4.0 - n) for n, name in enumerate(names)]
    told.journal.listen(News(ring="r", events=events))
    told.look()
    assert [(e.name, e.kind, e.tick) for e in told.said()] == [
        ("PLC_STALE", "alarm", 42),
        ("SPLICE", "roll", 42),
        ("BYPASSED", "state", 42),
    ]
    assert told.said()[0].utc_s == pytest.approx(WALL_S - 4.0)


def test_a_screen_that_starts_anew_does_not_write_the_same_again(told: Told) -> None:
    events = [of_ring(told, "PLC_STALE", 4.0)]
    for _ in range(2):
        told.journal.listen(News(ring="r", events=events))
        told.look()
        told.journal = told.begun()
    told.journal.listen(News(ring="another", events=events))
    told.look()
    assert told.names == ["PLC_STALE", "PLC_STALE"]


def test_every_change_of_state_is_dated_by_its_tick(told: Told) -> None:
    told.ticks((9.0, 1800.0, State.READY, 1.0))
    told.ticks(
        (10.000, 2000.0, State.READY, 1.0),
        (10.005, 2001.0, State.ARMED, 1.0),
        (10.010, 2002.0, State.ACTIVE, 1.0),
        (10.100, 2020.0, State.ACTIVE, 1.0),
    )
    found = told.said()
    assert [(e.name, e.tick) for e in found] == [
        ("READY", 1800),
        ("READY → ARMED", 2001),
        ("ARMED → ACTIVE", 2002),
    ]
    assert found[1].utc_s == pytest.approx(WALL_S - 0.095)


def test_a_record_without_these_columns_is_no_trouble(told: Told) -> None:
    told.journal.listen(News(ring="r", columns=("x",), records=[(1.0,)]))
    told.journal.listen(
        News(ring="r", columns=COLUMNS[:3], records=[(9.0, 1.0, State.READY), (9.1, 2.0, 99.0)])
    )
    told.look()
    assert told.names == ["READY"]


def test_another_roll_is_told(told: Told) -> None:
    told.ticks((9.0, 1.0, State.READY, 41.0))
    told.ticks((9.1, 2.0, State.READY, 42.0))
    (entry,) = told.said(kind="roll")
    assert entry.values == {"number": "42"}


def test_an_order_that_rests_is_told_with_its_roll_and_so_is_its_return(told: Told) -> None:
    resting = row(**{"unwind.unwind_2x.state": float(OrderState.HELD_PHASE)})
    told.look()
    for after_s in (0.5, 4.0, 2.0):
        told.look(seen(resting), after_s=after_s)
    (entry,) = told.said(roll="unwind")
    assert entry.name == "unwind: unwind_2x"
    assert "60 deg" in entry.text
    for after_s in (0.5, 6.0):
        told.look(after_s=after_s)
    assert [e.text for e in told.said(roll="unwind")][1:] == ["works again"]


def test_an_order_that_rests_for_a_moment_is_not(told: Told) -> None:
    resting = row(**{"unwind.unwind_2x.state": float(OrderState.HELD_PHASE)})
    for _ in range(20):
        told.look(seen(resting), after_s=3.0)
        told.look(after_s=3.0)
    assert told.said(roll="unwind") == []


def test_changes_of_the_facts_are_told_and_their_standing_is_not(told: Told) -> None:
    told.look()
    now = facts()
    after = [
        facts(config_hash="ab" * 32),
        facts(config_hash="ab" * 32, trying="for 120 s"),
        facts(config_hash="ab" * 32, probing=True),
        facts(config_hash="ab" * 32, control_pid=0),
        facts(config_hash="ab" * 32, shapes=("unwind: 14 orders saved",)),
        now,
    ]
    for moment in after:
        for _ in range(3):
            told.look(seen(facts=moment))
    names = [e.name for e in told.said()]
    assert names == [
        *("SETTINGS", "TRY", "TRY", "PROBE", "PROBE", "CONTROL", "CONTROL", "SHAPE", "SETTINGS")
    ]
    assert told.said()[0].values == {"after": "abababab", "before": "3f9a3f9a"}


def test_a_service_that_is_not_heard_any_more_is_told_once(told: Told) -> None:
    told.look()
    for _ in range(3):
        told.look(replace(seen(), trouble="closed"))
    told.look()
    texts = [e.text for e in told.said(kind="service")]
    assert texts == ["the service is not heard any more", "the service is heard"]


def test_a_clock_that_was_set_is_told_once_for_each_step(told: Told) -> None:
    for step_s in (0.0, 3.0, 3.0, -2.5, 0.0):
        told.look(seen(clock_step_s=step_s))
    assert [(e.name, e.values["seconds"]) for e in told.said(kind="service")] == [
        ("CLOCK", "+3.0"),
        ("CLOCK", "-2.5"),
    ]


def test_who_commands_on_the_console_is_told_with_the_time_of_it_and_once(told: Told) -> None:
    first = OperatorNote(utc_s=WALL_S - 60.0, did="arm", who="login anna (root)")
    second = OperatorNote(utc_s=WALL_S, did="shadow on", who="login bert")
    for operators in ((first,), (first,), (first, second)):
        told.look(seen(facts=facts(operators=operators)))
    told.journal = told.begun()  # another start of the screen hears of the same again
    told.look(seen(facts=facts(operators=(first, second))))
    assert [(e.utc_s, e.who, e.values["did"]) for e in told.said(kind="person")] == [
        (WALL_S - 60.0, "login anna (root)", "arm"),
        (WALL_S, "login bert", "shadow on"),
    ]


def test_a_try_names_who_began_it(told: Told) -> None:
    told.look()
    told.look(seen(facts=facts(trying="settings 0123 by carl: at the panel")))
    assert [e.who for e in told.said(kind="settings")] == ["carl: at the panel"]


def test_missed_ticks_are_told_once_a_minute(told: Told) -> None:
    told.look(seen(row(missed_count=5.0)))
    for n in range(10):
        told.look(seen(row(missed_count=6.0 + n)), after_s=1.0)
    told.look(seen(row(missed_count=15.0)), after_s=60.0)
    assert [e.values for e in told.said(kind="service")] == [{"count": "1"}, {"count": "9"}]


def test_words_of_others_are_made_printable_and_short(told: Told) -> None:
    told.look()
    told.look(seen(facts=facts(shapes=("\x1b[31m\u202e<b>" + "x" * 500,))))
    (entry,) = told.said()
    assert "\x1b" not in entry.values["said"]
    assert "\u202e" not in entry.values["said"]
    assert len(entry.values["said"]) <= 200


def test_a_flood_of_events_costs_its_own_tail(told: Told) -> None:
    ticks = [(9.0 + n, float(n), State.READY, float(n)) for n in range(5000)]
    told.ticks(*ticks)
    assert len(told.said()) <= 200
