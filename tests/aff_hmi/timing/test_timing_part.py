"""What the page of timing says, and that it claims nothing that is not known."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, replace
from pathlib import Path
from types import SimpleNamespace

import pytest

pytest.importorskip("starlette")

from aff_hmi.counts import Counts
from aff_hmi.layout import Layout
from aff_hmi.see.store import Store
from aff_hmi.timing.rights import KNOWN, right_lines
from aff_hmi.timing.timing import Timing
from aff_hmi.timing.usage import server_usage
from aff_hmi.timing.who import PLACE_WORDS, ROLE_WORDS, who_lines
from aff_hmi.watch import Observed
from aff_hmi.words import say_in
from aff_runtime.app.hand.may import Action, Person
from aff_runtime.app.hand.may import may as judge
from aff_runtime.app.report.metrics.catalogue import BY_NAME, HISTOGRAM
from aff_runtime.base.machine import machine
from aff_runtime.base.signals import State
from aff_runtime.loop.realtime import RealtimeRequest, ask
from aff_runtime.telemetry.header import Right, RunMeta
from tests.aff_hmi.moments import facts, row, seen
from tests.aff_hmi.pressed import Pressed, quick
from tests.aff_hmi.scope.played import news
from tests.doubles.virtual_clock import VirtualClock

EN, DE = say_in("en"), say_in("de")


def timing(clock: VirtualClock | None = None) -> Timing:
    return Timing(clock or VirtualClock(1), Counts(), None, Store(None, ()))


def test_every_tick_is_counted_and_what_is_longer_than_the_cycle_is_told() -> None:
    page = timing()
    page.look(seen(row(missed_count=3.0)), Layout())
    page.listen(news(range(100)))
    page.listen(news([100, 101], tick_us=5001.0))
    part = page.part(EN)
    assert (part.ticks, part.late, part.missed, part.cycle_ms) == (102, 2, 3, 5.0)
    named = {one.name: one for one in part.times}
    whole = named["whole tick"]
    assert (whole.whole.count, whole.whole.largest) == (102, 5001.0)
    assert named["age of the PLC's data"].whole.largest == pytest.approx(4000.0)
    assert sum(whole.counts) == 102
    json.dumps(asdict(part), allow_nan=False)


def test_a_monitoring_system_is_told_the_same_ticks_up_to_every_edge() -> None:
    page = timing()
    page.look(seen(), Layout())
    for count, tick_us in ((3, 90.0), (2, 150.0), (1, 60_000.0)):
        page.listen(news(range(count), tick_us=tick_us))
    histograms = {one.metric: one for one in page.histograms()}
    assert {BY_NAME[name].kind for name in histograms} == {HISTOGRAM}
    whole = histograms["aff_tick_duration_seconds"]
    below = dict(whole.buckets)
    edges = list(below)
    assert edges[:2] == [pytest.approx(50e-6, rel=0.01), 1e-4]
    assert edges[-2:] == [pytest.approx(50e-3, rel=0.01), math.inf]
    assert (below[edges[0]], below[1e-4], below[edges[2]]) == (0.0, 3.0, 5.0)
    assert (below[edges[-2]], below[math.inf]) == (5.0, 6.0)
    assert whole.total == pytest.approx(3 * 90e-6 + 2 * 150e-6 + 0.06)


def test_before_anything_is_known_nothing_is_claimed() -> None:
    part = timing().part(DE)
    assert (part.cycle_ms, part.missed, part.rows, part.facts_age_s) == (None, None, None, None)
    assert part.rights == part.who == ()
    assert all(one.whole.p99 is None for one in part.times)
    json.dumps(asdict(part), allow_nan=False)


def test_every_right_that_is_asked_for_has_its_words() -> None:
    asked = ask(RealtimeRequest(lock_memory=False, fifo_priority=0, quiet_collector=False))
    lines = (*asked.lines(), "memory locked: granted", "garbage collector off: granted")
    lines += ("SCHED_FIFO 80: refused, [Errno 1] Operation not permitted", "on processor 1: x")
    for line in lines:
        assert any(line.startswith(begin) for begin in KNOWN), line


def test_refused_rights_come_first_with_what_it_costs() -> None:
    rights = (
        Right(granted=True, text="memory locked: granted"),
        Right(granted=False, text="SCHED_FIFO 80: refused, [Errno 1] Operation not permitted"),
        Right(granted=False, text="<b>\u202e new: refused"),
    )
    first, second, third = right_lines(rights, DE)
    assert not first.granted
    assert "SCHED_FIFO" in first.name
    assert "Millisekunden" in first.cost
    assert "\u202e" not in second.name
    assert second.cost == ""
    assert third.granted
    assert third.cost == ""


@pytest.mark.parametrize("blocked", ["", "REMOTE", "WEB_INTACT=0"])
def test_who_may_what_is_what_the_press_is_judged_by(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, blocked: str
) -> None:
    quick(monkeypatch)
    at = Pressed(tmp_path)
    at.show(State.READY, blocked=blocked)
    lines = who_lines(at.hand, EN)
    assert len(lines) == len(ROLE_WORDS) * len(PLACE_WORDS)
    now = at.hand._circumstances()
    for (role, place), line in zip(
        [(r, p) for r in ROLE_WORDS for p in PLACE_WORDS], lines, strict=True
    ):
        person = Person(role=role, place=place)
        for action, said in ((Action.BYPASS, line.bypass), (Action.ARM, line.arm)):
            assert [one.text for one in judge(action, person, now)] == list(said)


def test_machine_is_read_and_what_is_not_there_is_not_guessed(tmp_path: Path) -> None:
    nothing = machine(tmp_path)
    assert (nothing.governors, nothing.isolated, nothing.is_realtime) == ("", "", None)
    cpu = tmp_path / "devices/system/cpu"
    for n, governor in enumerate(("performance", "powersave", "powersave")):
        (cpu / f"cpufreq/policy{n}").mkdir(parents=True)
        (cpu / f"cpufreq/policy{n}/scaling_governor").write_text(f"{governor}\n")
    (cpu / "isolated").write_text("\n")
    found = machine(tmp_path)
    assert (found.governors, found.isolated) == ("performance, powersave", "-")
    assert found.is_realtime is False
    (tmp_path / "kernel").mkdir()
    (tmp_path / "kernel/realtime").write_text("1\n")
    (cpu / "isolated").write_text("3\n")
    found = machine(tmp_path)
    assert (found.isolated, found.is_realtime) == ("3", True)


def test_the_screen_tells_what_it_uses_itself() -> None:
    found = server_usage()
    assert found.cpu_s > 0.0
    assert found.memory_MB is not None
    assert found.memory_MB > 5.0


def test_a_hostile_kernel_and_history_print(tmp_path: Path) -> None:
    page = timing()
    hostile = "x\u202e<script>\n" * 50
    moment: Observed = replace(seen(), meta=RunMeta(machine=hostile), facts=facts())
    page.look(moment, Layout())
    page._store = SimpleNamespace(trouble=hostile)  # type: ignore[assignment]
    part = page.part(EN)
    for text in (part.kernel, part.history):
        assert text.isprintable()
        assert len(text) <= 120
