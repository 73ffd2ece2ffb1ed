"""Whose commands the PLC takes: no false alarm on a live wire, one for every other master."""

from __future__ import annotations

from dataclasses import dataclass, replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from aff_runtime.base.signals import NO_ECHO, Outcome
from aff_runtime.safety.echo_check import EchoCheck
from aff_runtime.safety.params import EchoParams
from tests.aff_runtime.safety.snapshots import GOOD
from tests.each_case import each_case

WORD = 1 << 16
MS = 1_000_000
STALE_MS = 80
TICK_MS = 5
PARAMS = EchoParams(ticks=3 * STALE_MS // TICK_MS + 2, missing_after_s=STALE_MS * 1e-3)


class Bench:
    """Ticks with a given echo; ``first`` is the heartbeat before the first one."""

    def __init__(self, first: int = 0) -> None:
        self.judge = EchoCheck(PARAMS)
        self.first = first
        self.tick = 0

    @property
    def heartbeat(self) -> int:
        return (self.first + self.tick) % WORD

    def see(self, echo: int, *, fresh: bool = True, outcome: Outcome = Outcome.OK) -> bool:
        self.tick += 1
        age = (self.heartbeat - echo) % WORD if outcome is Outcome.OK else NO_ECHO
        shot = replace(GOOD, tick=self.tick, echo_age=age, fresh=fresh, outcome=outcome)
        return self.judge.judge(shot, self.tick * TICK_MS * MS)

    def ours(self, ticks: int = 1) -> list[bool]:
        return [self.see(self.heartbeat) for _ in range(ticks)]

    def settled(self) -> Bench:
        self.see(self.heartbeat)
        assert not any(self.ours(60))
        return self


def test_three_heartbeats_of_somebody_else_are_enough_and_two_are_not() -> None:
    bench = Bench().settled()
    assert [bench.see(40_000 + k) for k in range(4)] == [False, False, True, True]


def test_ours_by_turns_with_another_s_is_not_ours_alone() -> None:
    bench = Bench().settled()
    seen = [bench.see(40_000 + k // 3) if k % 3 == 0 else bench.ours()[0] for k in range(20)]
    assert seen == [False] * 6 + [True] * 14


def test_an_other_that_writes_the_same_word_again_and_again_is_seen_as_well() -> None:
    bench = Bench().settled()
    seen = [bench.see(0) if k % 2 == 0 else bench.ours()[0] for k in range(6)]
    assert seen == [False] * 4 + [True] * 2


def test_what_is_never_ours_is_a_fault_after_the_time_of_a_stale_plc() -> None:
    bench = Bench().settled()
    seen = [bench.see(40_000) for _ in range(30)]
    assert seen == [False] * 17 + [True] * 13  # from 0 to 80 ms are 17 ticks; the next is late


def test_it_is_over_half_a_second_after_the_last_strange_echo() -> None:
    bench = Bench().settled()
    assert [bench.see(40_000 + k) for k in range(3)][-1]
    assert bench.ours(150) == [True] * 100 + [False] * 50


def test_what_is_neither_fresh_nor_good_changes_nothing() -> None:
    bench = Bench().settled()
    assert not any(bench.see(40_000 + k, fresh=False) for k in range(100))
    assert not any(bench.see(0, outcome=Outcome.TIMEOUT) for _ in range(100))
    seen = [bench.see(40_000 + k) for k in range(4)]
    assert seen == [False, False, False, True]  # the first after a loss is no sign of anybody
    assert all(bench.see(0, outcome=Outcome.TIMEOUT) for _ in range(200))


@pytest.mark.parametrize(("lost", "is_told"), [(15, True), (16, False), (40, False)])
def test_an_echo_after_a_loss_longer_than_a_stale_plc_is_no_sign_of_anybody(
    lost: int, is_told: bool
) -> None:
    """From echo to echo 15 lost ticks are 80 ms, 16 are 85: what was left is then anybody's."""
    bench = Bench().settled()
    assert not any(bench.see(0, outcome=Outcome.TIMEOUT) for _ in range(lost))
    seen = [bench.see(40_000 + k) for k in range(4)]
    assert seen == [False, False, is_told, True]


@pytest.mark.parametrize(("lost", "later"), [(15, 0), (16, 16), (40, 16)])
def test_how_long_no_echo_was_ours_is_judged_anew_after_such_a_loss(lost: int, later: int) -> None:
    bench = Bench().settled()
    assert not any(bench.see(40_000) for _ in range(3))
    assert not any(bench.see(0, outcome=Outcome.TIMEOUT) for _ in range(lost))
    seen = [bench.see(40_000) for _ in range(30)]
    assert seen.index(True) == (later and later + 1)


def test_without_the_word_nothing_is_ever_judged() -> None:
    judge = EchoCheck(PARAMS)
    for k in range(1000):
        assert not judge.judge(replace(GOOD, tick=k, echo_age=NO_ECHO), k * TICK_MS * MS)
    assert not judge.heard


@each_case("first", [0, 65_500, 65_535])
@each_case(("age", "is_ours"), [(0, True), (50, True), (51, False), (65_535, False)])
def test_ours_is_what_was_sent_within_the_window_across_the_wrap(
    first: int, age: int, is_ours: bool
) -> None:
    bench = Bench(first).settled()
    for _ in range(30):
        last = bench.see((bench.heartbeat + 1 - age) % WORD)
    assert last is not is_ours


def test_what_was_never_sent_is_not_ours_however_near() -> None:
    bench = Bench(65_530)
    for _ in range(3):
        bench.see((bench.heartbeat - 10) % WORD)
    assert not bench.judge.heard


@dataclass
class Wire:
    """Commands out, scans, readings back: each late by its own number of ms."""

    scan_ms: int
    outs: list[int]
    backs: list[int]
    first: int
    left: int  # what the PLC holds before anything of ours

    def alarms(self, ticks: int, *, cut: range = range(0), restart: int = 0) -> list[int]:
        """Return the ticks with an alarm; ``cut``: nothing passes; ``restart``: PLC, at a tick."""
        judge = EchoCheck(PARAMS)
        arrivals: list[tuple[int, int]] = []  # of commands: time, tick
        readings: list[tuple[int, int, int]] = []  # time, scan, echo
        found, held, seen_scan, was_cut = [], self.left, -1, True
        for now in range(ticks * TICK_MS):
            tick = now // TICK_MS + 1
            is_cut = tick in cut
            if is_cut:
                arrivals.clear()
                readings.clear()
            if tick == restart and now % TICK_MS == 0:
                held = 0
                arrivals.clear()
            if now % TICK_MS == 0:
                here = max((r for r in readings if r[0] <= now), key=lambda r: r[1], default=None)
                moved = here is not None and here[1] > seen_scan
                shot = replace(GOOD, tick=tick, fresh=moved and not was_cut)
                if here is not None and moved:
                    was_cut, seen_scan = False, here[1]
                    echo_age = (self.first + tick - here[2]) % WORD
                    shot = replace(shot, echo_age=echo_age)
                was_cut = was_cut or is_cut
                if judge.judge(shot, now * MS) and judge.heard:
                    found.append(tick)
                if not is_cut:
                    arrivals.append((now + self.outs[tick % len(self.outs)], tick))
            if now % self.scan_ms == 0:
                taken = [t for at, t in arrivals if at <= now]
                if taken:
                    held = (self.first + max(taken)) % WORD
                    arrivals = [a for a in arrivals if a[1] >= max(taken)]
                if not is_cut:
                    late = self.backs[now // self.scan_ms % len(self.backs)]
                    readings.append((now + late, now, held))
                    readings = readings[-200:]
        return found


def delays(most_ms: int) -> st.SearchStrategy[list[int]]:
    return st.lists(st.integers(0, most_ms), min_size=1, max_size=40)


WORDS = st.integers(0, WORD - 1)


@settings(deadline=None)
@given(
    scan=st.integers(1, STALE_MS),
    outs=delays(STALE_MS),
    backs=delays(STALE_MS),
    first=WORDS,
    left=WORDS,
)
def test_no_delay_and_no_jitter_within_the_stale_time_is_an_alarm(
    scan: int, outs: list[int], backs: list[int], first: int, left: int
) -> None:
    assert Wire(scan, outs, backs, first, left).alarms(150) == []


@settings(deadline=None)
@given(
    scan=st.integers(1, 20),
    outs=delays(25),
    backs=delays(25),
    first=WORDS,
    left=WORDS,
    cut=st.integers(1, 150),
    restart=st.integers(40, 250),
)
def test_start_loss_and_a_restarted_plc_are_no_alarm(
    scan: int, outs: list[int], backs: list[int], first: int, left: int, cut: int, restart: int
) -> None:
    wire = Wire(scan, outs, backs, first, left)
    assert wire.alarms(300, cut=range(60, 60 + cut), restart=restart) == []


@given(ticks_a_scan=st.integers(1, 15), offset=st.integers(51, WORD - 15), first=WORDS)
def test_a_master_that_always_writes_last_is_found_by_its_third_heartbeat(
    ticks_a_scan: int, offset: int, first: int
) -> None:
    bench = Bench(first).settled()
    seen = []
    for k in range(3 * ticks_a_scan):
        theirs = bench.first + 62 + k // ticks_a_scan * ticks_a_scan - offset
        seen.append(bench.see(theirs % WORD))
    third = 2 * ticks_a_scan
    assert seen.index(True) == min(third, STALE_MS // TICK_MS + 1)
    assert all(seen[third:])
