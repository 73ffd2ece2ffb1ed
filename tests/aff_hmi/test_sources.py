"""Every tick reaches every source once: the scope at once, the others when they are looked at."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("starlette")

from aff_hmi.layout import layout_of
from aff_hmi.see.kept import LOOK_NS
from aff_hmi.sources import Sources
from aff_hmi.waiting import MUCH, Waiting
from aff_runtime.app.report.metrics.readings import Sample
from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import State
from tests.aff_hmi.moments import facts, seen
from tests.aff_hmi.pressed import Pressed
from tests.aff_hmi.scope.played import COLUMNS, CYCLE_S, news

SITE_OF = layout_of(facts(), ("unwind_tension_N",))


@pytest.fixture
def sources(keeping: Pressed) -> Sources:
    """All sources of a screen that keeps a history, of which the site is known."""
    assert keeping.hub.sources is not None
    keeping.hub.sources.listen(news([]))
    keeping.show(State.ACTIVE)
    return keeping.hub.sources


def told(sources: Sources, metric: str) -> float:
    """Return the sum of a metric over its labels."""
    samples = [one for one in sources.samples() if isinstance(one, Sample)]
    return sum(one.value for one in samples if one.metric == metric)


def test_what_adds_up_has_every_tick_once_when_it_is_asked(sources: Sources) -> None:
    for begin in range(0, 100, 20):
        sources.listen(news(range(begin, begin + 20), state=float(State.ACTIVE)))
    for _ in range(2):
        assert told(sources, "aff_active_seconds_total") == pytest.approx(100 * CYCLE_S)


def test_the_scope_has_a_tick_at_once_and_the_history_with_its_next_look(
    keeping: Pressed, sources: Sources
) -> None:
    heard: list[int] = []
    sources.kept.listen = lambda said: heard.append(len(said.records))  # type: ignore[method-assign]
    sources.listen(news(range(20)))
    assert sources.scope.ticks.newest() == 19
    sources.look(seen(), SITE_OF)
    assert heard == []
    sources.listen(news(range(20, 40)))
    keeping.clock.advance_ns(LOOK_NS)
    sources.look(seen(), SITE_OF)
    assert heard == [40]


def test_polls_of_one_ring_are_taken_as_one_and_those_of_another_are_not() -> None:
    code = float(BY_NAME["SPLICE"].code)
    waiting = Waiting()
    waiting.add(replace(news([0, 1]), events=[(0, 5, code, 0)]))
    for more in (news([]), news([2]), news([0], ring="two"), news([3])):
        waiting.add(more)
    found = waiting.take()
    assert [one.ring for one in found] == ["one", "two", "one"]
    ticks = [np.asarray(one.records)[:, COLUMNS.index("tick")].tolist() for one in found]
    assert ticks == [[0.0, 1.0, 2.0], [0.0], [3.0]]
    assert [list(one.events) for one in found] == [[(0, 5, code, 0)], [], []]
    assert waiting.take() == []


def test_ticks_do_not_wait_for_ever() -> None:
    waiting = Waiting()
    waiting.add(news(range(MUCH - 1)))
    assert not waiting.is_much
    waiting.add(news([MUCH]))
    assert waiting.is_much
    waiting.take()
    assert not waiting.is_much
