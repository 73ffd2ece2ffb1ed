from __future__ import annotations

from dataclasses import replace

import pytest

from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import Outcome, Snapshot, Status
from aff_runtime.safety.causes import bit
from aff_runtime.safety.line_check import LineCheck
from aff_runtime.safety.params import ChannelParams, GuardParams
from tests.aff_runtime.safety.bench import ALL_WELL, PARAMS, PERIOD_NS
from tests.each_case import each_case


class Line:
    def __init__(self, params: GuardParams = PARAMS) -> None:
        self.judge = LineCheck(params)
        self.now_ns = 0
        self.standing_N: float | None = None

    def see(
        self,
        *,
        tension_N: float = 90.0,
        speed_m_s: float = 1.0,
        radius_m: float = 0.2,
        status: int = ALL_WELL,
        roll_id: int = 1,
        outcome: Outcome = Outcome.OK,
        fresh: bool = True,
    ) -> int:
        self.now_ns += PERIOD_NS
        snapshot = Snapshot(
            tick=0,
            t_ns=self.now_ns,
            outcome=outcome,
            fresh=fresh and outcome is Outcome.OK,
            age_s=0.0,
            plc_heartbeat=0,
            status=status,
            roll_id=roll_id,
            values=(self.standing_N or tension_N + self.now_ns * 1e-15, speed_m_s, radius_m),
        )
        return self.judge.judge(snapshot, self.now_ns)


def test_a_healthy_line_has_no_cause_and_is_moving() -> None:
    line = Line()
    assert line.see() == 0
    assert line.judge.gates == [True, True]
    assert line.judge.missing() == ()


@each_case(
    "missing",
    [
        Status.LINE_RUN,
        Status.WEB_INTACT,
        Status.TENSION_VALID,
        Status.ESTOP_OK,
        Status.AFF_ENABLE_REQUEST,
    ],
)
def test_each_missing_permissive_is_a_cause_and_is_named(missing: Status) -> None:
    line = Line()
    assert line.see(status=ALL_WELL & ~missing) == bit("PERMISSIVE_LOST")
    assert line.judge.missing() == (f"{missing.name}=0",)


def test_all_missing_permissives_are_named_in_the_order_of_the_site_file() -> None:
    line = Line()
    line.see(status=0)
    assert line.judge.missing() == tuple(f"{one.name}=0" for one in PARAMS.permissives.all_bits)
    assert line.judge.missing()[0] == "LINE_RUN=0"


def test_speed_opens_and_closes_with_hysteresis_per_actuator() -> None:
    line = Line()
    seen = []
    for speed_m_s in (0.1, 0.11, 0.5, 0.51, 0.41, 0.40, 0.081, 0.08, -1.0):
        line.see(speed_m_s=speed_m_s)
        seen.append(tuple(line.judge.gates))
    assert seen == [
        (False, False),
        (True, False),
        (True, False),
        (True, True),
        (True, True),
        (True, False),
        (True, False),
        (False, False),
        (False, False),
    ]


def test_a_line_that_stands_still_may_show_a_slack_web() -> None:
    line = Line()
    assert line.see(tension_N=0.0, speed_m_s=0.0) == 0
    assert line.see(tension_N=0.0, speed_m_s=1.0) == bit("TENSION_IMPLAUSIBLE")
    assert line.judge.unbelievable == {BY_NAME["TENSION_IMPLAUSIBLE"].code: "unwind_tension_N"}


def test_an_absurd_speed_backwards_does_not_hide_behind_the_closed_gate() -> None:
    line = Line()
    line.see()
    assert line.see(speed_m_s=-30.0) == bit("SIGNAL_IMPLAUSIBLE")


def test_a_verdict_stands_through_lost_transactions() -> None:
    line = Line()
    line.see()
    line.see(tension_N=500.0)
    assert line.see(outcome=Outcome.TIMEOUT) == bit("TENSION_IMPLAUSIBLE")


def test_a_new_roll_is_a_splice_for_a_while_and_its_radius_is_accepted() -> None:
    line = Line()
    line.see()
    assert line.see(roll_id=2, radius_m=0.2) == bit("SPLICE")
    causes = [line.see(roll_id=2, radius_m=0.4) for _ in range(25)]
    settle_ticks = round(PARAMS.splice_settle_s * 1e9) // PERIOD_NS
    assert causes[: settle_ticks - 1] == [bit("SPLICE")] * (settle_ticks - 1)
    assert causes[settle_ticks:] == [0] * (25 - settle_ticks)


def test_a_radius_that_jumps_on_the_same_roll_is_a_cause_until_confirmed() -> None:
    line = Line()
    line.see()
    assert line.see(radius_m=0.3) == bit("RADIUS_JUMP")
    assert line.see(radius_m=0.3) == bit("RADIUS_JUMP")
    line.judge.confirm_rolls()
    assert line.see(radius_m=0.3) == 0


def test_a_repeated_reading_of_a_slow_plc_does_not_count_as_a_new_one() -> None:
    quick = ChannelParams(channel=0, name="unwind_tension_N", rate_max=150.0)
    line = Line(replace(PARAMS, channels=(quick,)))
    for k in range(20):  # 1 N per 10 ms, each reading seen twice
        assert line.see(tension_N=90.0 + k) == 0
        assert line.see(tension_N=90.0 + k, fresh=False) == 0
    assert line.see(tension_N=113.0) == bit("SIGNAL_IMPLAUSIBLE")


def test_without_the_enable_of_the_plc_only_the_needed_bits_count() -> None:
    permissives = replace(PARAMS.permissives, enable_from_plc=False)
    line = Line(replace(PARAMS, permissives=permissives))
    assert line.see(status=ALL_WELL & ~Status.AFF_ENABLE_REQUEST) == 0


def test_a_channel_beyond_the_readings_counts_as_not_a_number() -> None:
    line = Line()
    line.now_ns += PERIOD_NS
    short = Snapshot(
        tick=0,
        t_ns=0,
        outcome=Outcome.OK,
        fresh=True,
        age_s=0.0,
        plc_heartbeat=0,
        status=int(ALL_WELL),
        roll_id=1,
        values=(90.0,),
    )
    causes = line.judge.judge(short, line.now_ns)
    assert causes & bit("SIGNAL_IMPLAUSIBLE")
    assert line.judge.gates == [False, False]


@pytest.mark.parametrize(
    ("gap_s", "stuck"), [(0.070, True), (PARAMS.freshness.fault_after_s + 0.01, False)]
)
def test_time_in_which_nothing_was_heard_is_not_time_in_which_a_signal_stood(
    gap_s: float, stuck: bool
) -> None:
    stuck_after_s = PARAMS.channels[0].stuck_after_s
    line = Line()
    line.standing_N = 90.0
    before = round((stuck_after_s - 0.05) / 0.005)
    assert [line.see() for _ in range(before)] == [0] * before
    line.now_ns += round(gap_s * 1e9) - PERIOD_NS
    assert bool(line.see() & bit("TENSION_IMPLAUSIBLE")) is stuck
    after = [line.see() for _ in range(round(stuck_after_s / 0.005) + 1)]
    assert after[-1] == bit("TENSION_IMPLAUSIBLE")  # one that goes on standing is found
