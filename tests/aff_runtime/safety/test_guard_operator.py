from __future__ import annotations

from collections.abc import Callable
from math import nan

import pytest

from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import Outcome, State, StateBits, Status
from tests.aff_runtime.safety.bench import FADE_S, PARAMS, PERIOD_S, STEP, Bench
from tests.each_case import each_case

FADE_TICKS = round(FADE_S / PERIOD_S)
FAULT_TICKS = round(PARAMS.freshness.fault_after_s / PERIOD_S)
STUCK_TICKS = round(PARAMS.channels[0].stuck_after_s / PERIOD_S)
ZEROS_TOLD = 3  # commands with zero that still say FADING
IDLE_SCANS = 3


def test_it_starts_in_fault_with_zero_and_says_power_up() -> None:
    bench = Bench()
    assert bench.guard.drain_events() == [(0, BY_NAME["POWER_UP"].code)]
    bench.run(100)
    assert bench.state is State.FAULT
    assert bench.out == (0.0, 0.0)
    assert bench.alarm == BY_NAME["POWER_UP"].code
    assert bench.bits & StateBits.FAULT
    assert not bench.bits & (StateBits.ACTIVE | StateBits.FADING | StateBits.ARMED)


def test_before_the_first_connection_the_alarm_stays_power_up() -> None:
    bench = Bench()
    bench.outcome = Outcome.NOT_CONNECTED
    bench.run(200)
    bench.overrun = True
    bench.run()
    bench.overrun = False
    assert bench.alarm == BY_NAME["POWER_UP"].code
    assert bench.codes() == ["POWER_UP"]
    assert bench.guard.first_blocking() == "blocked by PLC_STALE"
    bench.outcome = Outcome.OK
    bench.run(50)
    assert bench.alarm == BY_NAME["POWER_UP"].code
    assert bench.guard.first_blocking() == ""


def test_a_connection_lost_before_the_first_arm_is_an_alarm() -> None:
    bench = Bench()
    bench.run(10)
    bench.outcome = Outcome.TIMEOUT
    bench.run(FAULT_TICKS + 1)
    assert bench.alarm == BY_NAME["PLC_STALE"].code
    assert bench.codes() == ["POWER_UP", "PLC_STALE"]


def test_a_dead_supervisor_is_news_even_before_the_first_connection() -> None:
    bench = Bench()
    bench.outcome = Outcome.NOT_CONNECTED
    bench.supervisor_alive = False
    bench.run(2)
    assert bench.alarm == BY_NAME["SUPERVISOR_LOST"].code


def test_arming_opens_softly_from_zero_to_the_whole_wish() -> None:
    bench = Bench()
    bench.run()
    assert bench.guard.arm() == ""
    outputs = []
    for _ in range(60):
        bench.run()
        outputs.append(bench.out[0])
    assert bench.state is State.ACTIVE
    assert outputs == sorted(outputs)
    assert outputs[0] < 0.05 * STEP.value
    assert outputs[19] == pytest.approx(STEP.value / 2)  # half of soft_start_s = 0.2 s
    assert outputs[-1] == STEP.value
    assert bench.bits & StateBits.ACTIVE
    assert bench.bits & StateBits.ARMED
    assert bench.alarm == 0


@each_case(
    ("spoil", "reason"),
    [
        (lambda b: b.clear(Status.WEB_INTACT), "blocked by WEB_INTACT=0"),
        (lambda b: b.clear(Status.AFF_ENABLE_REQUEST), "blocked by AFF_ENABLE_REQUEST=0"),
        (lambda b: b.set(Status.SPLICE_ACTIVE), "blocked by SPLICE"),
        (lambda b: setattr(b, "tension_N", nan), "blocked by TENSION_IMPLAUSIBLE"),
        (lambda b: setattr(b, "overrun", True), "blocked by OVERRUN"),
        (lambda b: setattr(b, "supervisor_alive", False), "blocked by SUPERVISOR_LOST"),
        (lambda b: setattr(b.guard, "objections", ("no response file",)), "no response file"),
        (lambda b: b.guard.shadow(True), "blocked by SHADOW=1"),
    ],
)
def test_arming_is_refused_and_the_first_reason_is_named(
    spoil: Callable[[Bench], None], reason: str
) -> None:
    bench = Bench()
    spoil(bench)
    bench.run()
    assert reason in bench.guard.arm()
    bench.run(100)
    assert bench.out == (0.0, 0.0)
    assert bench.state is not State.ACTIVE
    assert not bench.guard.standing.armed


def test_arming_without_any_data_is_refused() -> None:
    bench = Bench()
    bench.outcome = Outcome.NOT_CONNECTED
    bench.run(50)
    assert bench.guard.arm() == "blocked by PLC_STALE"
    bench.run()
    assert bench.state is State.FAULT
    bench.outcome = Outcome.OK
    bench.run(50)
    assert bench.state is State.FAULT


def test_an_armed_guard_waits_for_line_speed_per_actuator() -> None:
    bench = Bench()
    bench.speed_m_s = 0.05
    bench.arm()
    assert bench.state is State.ARMED
    assert bench.out == (0.0, 0.0)
    bench.speed_m_s = 0.3
    bench.run_s(0.5)
    assert bench.state is State.ACTIVE
    assert bench.out == (STEP.value, 0.0)
    bench.speed_m_s = 0.6
    bench.run_s(0.5)
    assert bench.out == (STEP.value, STEP.value)
    bench.speed_m_s = 0.0
    bench.run()
    assert bench.state is State.FADING
    assert bench.bits & StateBits.FADING
    bench.run(FADE_TICKS)
    assert bench.out == (0.0, 0.0)
    assert bench.state is State.ARMED


def test_bypass_acts_in_one_tick_and_stays_until_armed() -> None:
    bench = Bench().active()
    bench.guard.bypass()
    bench.run()
    assert bench.state is State.BYPASS
    assert bench.bits & StateBits.BYPASS
    assert bench.bits & StateBits.FADING
    assert bench.alarm == BY_NAME["BYPASSED"].code
    bench.run(FADE_TICKS - 1)
    assert bench.out == (0.0, 0.0)
    bench.run(200)
    assert bench.state is State.BYPASS
    assert bench.guard.arm() == ""
    bench.run(60)
    assert bench.state is State.ACTIVE


def test_an_arm_pressed_during_the_fade_of_a_bypass_is_honoured_at_its_end() -> None:
    bench = Bench().active()
    bench.guard.bypass()
    bench.run(3)
    bench.guard.arm()
    outputs = []
    idle = 0
    for _ in range(FADE_TICKS + ZEROS_TOLD + IDLE_SCANS):
        bench.run()
        outputs.append(bench.out[0])
        idle += not bench.bits & (StateBits.ACTIVE | StateBits.FADING)
    assert 0.0 in outputs
    assert idle >= IDLE_SCANS  # a PLC that refuses listens again only after it saw us idle
    assert bench.state is State.ACTIVE


def test_an_arm_pressed_before_a_fault_does_not_outlive_it() -> None:
    bench = Bench().active()
    bench.guard.arm()
    bench.run()
    bench.tension_N = nan
    bench.guard.arm()
    bench.run(3)
    bench.guard.arm()
    bench.run()
    bench.tension_N = 90.0
    bench.run(200)
    assert bench.state is State.FAULT


@pytest.mark.parametrize("bypass_first", [True, False])
def test_bypass_beats_an_arm_in_the_same_tick(bypass_first: bool) -> None:
    bench = Bench()
    bench.run()
    for order in (bench.guard.bypass, bench.guard.arm)[:: 1 if bypass_first else -1]:
        order()
    bench.run(50)
    assert bench.state is State.BYPASS


def test_shadow_computes_and_sends_zero_and_gives_up_being_armed() -> None:
    bench = Bench().active()
    bench.guard.shadow(True)
    bench.run()
    assert bench.state is State.SHADOW
    bench.run(FADE_TICKS)
    assert bench.out == (0.0, 0.0)
    assert bench.permission is not None
    assert bench.permission.applied_ratio == (0.0, 0.0)
    assert not bench.permission.adapt
    bench.guard.shadow(False)
    bench.run(100)
    assert bench.state is State.READY
    assert bench.out == (0.0, 0.0)


def test_shadow_asked_for_at_power_up_needs_one_edge_once_data_flow() -> None:
    bench = Bench()
    bench.guard.shadow(True)
    bench.run(5)
    assert bench.state is State.SHADOW
    bench.tension_N = nan
    bench.run()
    assert bench.state is State.FAULT
    bench.tension_N = 90.0
    bench.run(50)
    assert bench.state is State.FAULT


def test_another_radius_seen_in_bypass_is_confirmed_by_the_arm_that_follows() -> None:
    bench = Bench().active()
    bench.guard.bypass()
    bench.run(FADE_TICKS + ZEROS_TOLD + IDLE_SCANS)
    bench.radius_m = 0.3  # another roll, and the PLC did not tell
    bench.run(100)
    assert bench.state is State.BYPASS
    assert bench.guard.first_blocking() == "blocked by RADIUS_JUMP (unwind_radius_m)"
    bench.guard.arm()
    bench.run_s(0.5)
    assert bench.state is State.ACTIVE
    assert bench.out == (STEP.value, STEP.value)


def test_another_radius_while_active_is_not_confirmed_by_an_arm_of_before() -> None:
    bench = Bench().active()
    bench.guard.arm()
    bench.radius_m = 0.3
    bench.run(2)
    assert bench.state is State.FAULT
