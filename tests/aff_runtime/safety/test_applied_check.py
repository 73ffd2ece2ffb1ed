"""What the PLC applies: ours, zero, or on the way between; everything else is somebody else's."""

from __future__ import annotations

from dataclasses import replace
from math import nan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aff_runtime.base.signals import NO_ECHO
from aff_runtime.safety.applied_check import AppliedCheck
from aff_runtime.safety.params import AppliedParams
from tests.aff_runtime.safety.snapshots import GOOD

MS = 1_000_000
TICK_MS = 5
COUNT = 0.00001
WITHIN = 2 * COUNT
PARAMS = AppliedParams(
    tolerances=(WITHIN,), units=("m/s",), ticks=50, lag_ticks=3, between_s=0.180, gap_s=0.080
)


class Bench:
    """Ticks of 5 ms; the PLC takes each command by the next tick, unless told otherwise."""

    def __init__(self, params: AppliedParams = PARAMS) -> None:
        self.judge = AppliedCheck(params, len(params.tolerances) or 1)
        self.sent = [0.0]
        self.tick = 0
        self.now_ms = 0

    def see(
        self,
        shown: float,
        send: float = 0.0,
        *,
        age: int = 1,
        fresh: bool = True,
        ms: int = TICK_MS,
    ) -> bool:
        """Send ``send`` in the next tick; return the verdict on what is shown in this one."""
        self.tick += 1
        self.now_ms += ms
        shot = replace(GOOD, tick=self.tick, echo_age=age, fresh=fresh, applied=(shown,))
        verdict = self.judge.judge(shot, self.now_ms * MS)
        self.judge.note_sent((send,))
        self.sent.append(send)
        return verdict

    def ours(self, *values: float) -> list[bool]:
        """Send the values and see each of them applied a tick later."""
        return [self.see(self.sent[-2] if self.tick else 0.0, value) for value in values]

    def working(self, value: float = 0.03) -> Bench:
        """Rise to a correction of some size that is applied."""
        steps = 10
        assert not any(self.ours(0.0, *(value * k / steps for k in range(1, steps + 1))))
        assert not any(self.ours(*(value,) * 10))
        return self


def first(seen: list[bool]) -> int:
    """Return which reading was the first to accuse, from 1; 0: none."""
    return seen.index(True) + 1 if True in seen else 0


@pytest.mark.parametrize("shown", [0.02, -0.02, 0.0001])
def test_something_while_we_send_zero_is_somebody_s_with_the_third_reading(shown: float) -> None:
    bench = Bench()
    bench.ours(*(0.0,) * 20)
    assert first([bench.see(shown) for _ in range(5)]) == 3


def test_what_is_beyond_ours_is_somebody_s_with_the_third_reading() -> None:
    bench = Bench().working(0.03)
    assert first([bench.see(0.04, 0.03) for _ in range(5)]) == 3
    bench = Bench().working(0.03)
    assert first([bench.see(-0.01, 0.03) for _ in range(5)]) == 3


@pytest.mark.parametrize(("off", "found"), [(1.9, 0), (2.1, 3)])
def test_a_count_of_each_word_is_no_difference_and_more_is(off: float, found: int) -> None:
    bench = Bench().working(0.03)
    assert first([bench.see(0.03 + off * COUNT, 0.03) for _ in range(20)]) == found


def test_zero_is_never_somebody_s_however_long() -> None:
    bench = Bench().working(0.03)
    assert not any(bench.see(0.0, 0.03) for _ in range(400))


@pytest.mark.parametrize("ours", [0.03, 0.0])
def test_a_ramp_to_zero_of_100_ms_is_none_and_what_stays_on_the_way_is(ours: float) -> None:
    ramp = [0.03 * (1.0 - k / 20) for k in range(1, 21)]
    bench = Bench().working(0.03)
    assert not any(bench.see(shown, ours) for shown in [*ramp, *(0.0,) * 100])
    bench = Bench().working(0.03)
    seen = [bench.see(shown, ours) for shown in [*ramp[:8], *(ramp[8],) * 60]]
    # 25 ms in which it may be of the command before, 180 ms, three readings beyond
    assert 180 < TICK_MS * first(seen) <= 25 + 180 + 5 * TICK_MS


def test_a_limit_of_the_plc_that_cuts_ours_is_none_for_any_time() -> None:
    bench, limit = Bench(), 0.01
    up = [0.03 * k / 30 for k in range(31)]
    wave = [*up, *(0.03,) * 200, *up[::-1], *(-v for v in up), *(-0.03,) * 200]
    shown = [0.0, 0.0, *(max(-limit, min(limit, v)) for v in wave)]
    assert not any(bench.see(s, w) for s, w in zip(shown, wave, strict=False))
    assert not any(bench.see(0.0, 0.03) for _ in range(20))  # refused for a while, without a ramp
    assert not any(bench.see(limit, 0.03) for _ in range(200))


def test_a_constant_of_somebody_between_zero_and_ours_is_found_within_300_ms() -> None:
    bench = Bench().working(0.03)
    found = first([bench.see(0.02, 0.03) for _ in range(60)])
    assert 180 < TICK_MS * found <= 205


def test_ours_that_passes_by_a_constant_of_somebody_does_not_make_it_ours() -> None:
    bench = Bench().working(0.03)
    swing = [0.03 * (1 - 2 * abs(k % 20 - 10) / 10) for k in range(200)]  # 10 Hz, triangular
    found = first([bench.see(0.02, value) for value in swing])
    assert TICK_MS * found <= 300
    assert found > 0


def test_a_plc_that_takes_every_third_command_shows_one_of_them() -> None:
    bench = Bench()
    swing = [0.03 * (1 - 2 * abs(k % 20 - 10) / 10) for k in range(400)]
    sent = [0.0, *swing]
    for tick in range(1, 300):
        taken = max(0, (tick - 1) // 3 * 3 - 3)
        fresh = tick % 3 == 1
        assert not bench.see(sent[max(0, taken - 1)], swing[tick], age=tick - taken, fresh=fresh)


@pytest.mark.parametrize("lag", [1, 2, 3])
def test_a_drive_that_is_behind_the_plc_is_none(lag: int) -> None:
    bench = Bench()
    swing = [0.03 * (1 - 2 * abs(k % 20 - 10) / 10) for k in range(400)]
    sent = [0.0, 0.0, *swing]
    shown = [sent[max(0, k - lag)] for k in range(400)]
    assert not any(bench.see(shown[k], swing[k]) for k in range(400))


def test_two_strange_readings_half_a_second_apart_are_forgotten() -> None:
    bench = Bench()
    bench.ours(*(0.0,) * 20)
    for _ in range(10):
        assert not any([bench.see(0.02), bench.see(0.02)])
        assert not any(bench.ours(*(0.0,) * 101))


def test_it_is_over_half_a_second_after_the_last_strange_reading() -> None:
    bench = Bench()
    bench.ours(*(0.0,) * 20)
    assert [bench.see(0.02) for _ in range(3)][-1]
    assert bench.ours(*(0.0,) * 150) == [True] * 100 + [False] * 50


def test_the_first_reading_may_be_anything_and_has_the_time_of_a_ramp() -> None:
    bench = Bench()
    assert not any(bench.see(0.05 * (1.0 - k / 20)) for k in range(40) if k <= 20)
    bench = Bench()
    found = first([bench.see(0.02) for _ in range(60)])
    assert 180 < TICK_MS * found <= 180 + 5 * TICK_MS


def test_the_first_reading_after_a_gap_may_be_anything() -> None:
    bench = Bench().working(0.03)
    assert not bench.see(0.05, 0.0, ms=81)
    assert not any(bench.see(0.05 * (1.0 - k / 20)) for k in range(1, 21))
    bench = Bench().working(0.03)
    assert first([bench.see(0.05, 0.0, ms=80), *(bench.see(0.05) for _ in range(5))]) == 3


def test_what_is_not_fresh_not_good_not_ours_or_no_number_is_not_judged() -> None:
    bench = Bench()
    bench.ours(*(0.0,) * 20)
    assert not any(bench.see(0.02, fresh=False) for _ in range(100))
    assert not any(bench.see(0.02, age=51) for _ in range(100))
    assert not any(bench.see(0.02, age=NO_ECHO) for _ in range(100))
    assert not any(bench.see(nan) for _ in range(100))
    bench.ours(0.0, 0.0, 0.0)
    assert first([bench.see(0.02) for _ in range(5)]) == 3


def test_between_fresh_readings_the_last_verdict_stands() -> None:
    bench = Bench()
    bench.ours(*(0.0,) * 20)
    assert [bench.see(0.02) for _ in range(3)][-1]
    assert all(bench.see(0.0, fresh=False) for _ in range(300))


def test_without_the_word_nothing_is_ever_judged() -> None:
    judge = AppliedCheck(AppliedParams(), 1)
    for tick in range(500):
        shot = replace(GOOD, tick=tick, echo_age=1, applied=(0.5,))
        assert not judge.judge(shot, tick * TICK_MS * MS)
        judge.note_sent((0.0,))


def test_one_of_two_that_is_not_shown_is_not_judged_and_the_other_is_named() -> None:
    params = replace(PARAMS, tolerances=(None, WITHIN), units=("m/s", "N m"))
    judge = AppliedCheck(params, 2)
    verdicts = []
    for tick in range(1, 30):
        shown = 0.02 if tick > 20 else 0.0
        shot = replace(GOOD, tick=tick, echo_age=1, applied=(nan, shown))
        verdicts.append(judge.judge(shot, tick * TICK_MS * MS))
        judge.note_sent((0.03, 0.0))
    assert first(verdicts) == 23
    said = judge.finding(["unwind", "rewind"])
    assert said == "rewind: 0.02 N m applied, 0 sent"


def test_what_was_sent_is_said_as_a_range_where_it_moved() -> None:
    bench = Bench().working(0.03)
    bench.ours(0.031, 0.032, 0.033)
    for _ in range(3):
        bench.see(-0.02, 0.033)
    assert bench.judge.finding(["unwind"]) == "unwind: -0.02 m/s applied, 0.03 to 0.033 sent"


@given(
    ages=st.lists(st.integers(1, 50), min_size=1, max_size=60),
    waves=st.lists(st.floats(-0.05, 0.05), min_size=1, max_size=40),
)
def test_whatever_command_the_echo_names_its_value_is_ours(
    ages: list[int], waves: list[float]
) -> None:
    bench = Bench()
    for k in range(3 * len(ages)):
        age = min(ages[k % len(ages)], bench.tick + 1)
        at = bench.tick + 1 - age  # the tick in which it went out
        shown = bench.sent[at - 1] if at > 0 else 0.0
        assert not bench.see(shown, waves[k % len(waves)], age=age)
