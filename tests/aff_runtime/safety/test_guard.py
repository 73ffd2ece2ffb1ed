from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import nan

import pytest

from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import ActuatorStep, Outcome, State, StateBits, Status
from tests.aff_runtime.safety.bench import (
    FADE_S,
    PARAMS,
    PERIOD_NS,
    PERIOD_S,
    STEP,
    Bench,
)

FADE_TICKS = round(FADE_S / PERIOD_S)
FAULT_TICKS = round(PARAMS.freshness.fault_after_s / PERIOD_S)
STUCK_TICKS = round(PARAMS.channels[0].stuck_after_s / PERIOD_S)


# --- starting and arming --------------------


def test_it_starts_in_fault_with_zero_and_says_power_up() -> None:
    bench = Bench()
    assert bench.guard.drain_events() == [(0, BY_NAME["POWER_UP"].code)]
    bench.run(100)
    assert bench.state is State.FAULT
    assert bench.out == (0.0, 0.0)
    assert bench.alarm == BY_NAME["POWER_UP"].code
    assert bench.bits & StateBits.FAULT
    assert not bench.bits & (StateBits.ACTIVE | StateBits.FADING | StateBits.ARMED)


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


@pytest.mark.parametrize(
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


# --- every fault --------------------


def mute(b: Bench) -> None:
    b.outcome = Outcome.TIMEOUT


def freeze(b: Bench) -> None:
    b.heartbeat_moves = False


def stick(b: Bench) -> None:
    b.tension_moves = False


def law_dies(b: Bench) -> None:
    b.steps = None


def law_is_short(b: Bench) -> None:
    b.steps = (STEP,)


def law_says_nan(b: Bench) -> None:
    b.steps = (replace(STEP, value=nan), STEP)


def ripple(b: Bench) -> None:
    b.guard.ripple_rose = True


def stall(b: Bench) -> None:
    b.now_ns += 20 * PERIOD_NS


LATCHING = [
    (mute, "PLC_STALE", FAULT_TICKS + 1),
    (freeze, "PLC_STALE", FAULT_TICKS + 1),
    (lambda b: setattr(b, "tension_N", nan), "TENSION_IMPLAUSIBLE", 1),
    (lambda b: setattr(b, "tension_N", 1e9), "TENSION_IMPLAUSIBLE", 1),
    (stick, "TENSION_IMPLAUSIBLE", STUCK_TICKS + 2),
    (lambda b: setattr(b, "speed_m_s", nan), "SIGNAL_IMPLAUSIBLE", 1),
    (lambda b: setattr(b, "speed_m_s", 20.0), "SIGNAL_IMPLAUSIBLE", 1),
    (lambda b: setattr(b, "radius_m", 0.3), "RADIUS_JUMP", 1),
    (lambda b: setattr(b, "overrun", True), "OVERRUN", 1),
    (stall, "OVERRUN", 1),
    (lambda b: setattr(b, "supervisor_alive", False), "SUPERVISOR_LOST", 1),
    (law_dies, "LEASE_EXPIRED", PARAMS.lease_ticks + 1),
    (law_is_short, "LEASE_EXPIRED", PARAMS.lease_ticks + 1),
    (law_says_nan, "INTERNAL_FAULT", 1),
    (lambda b: b.guard.internal_fault(), "INTERNAL_FAULT", 1),
    (ripple, "RIPPLE_ROSE", 1),
]


@pytest.mark.parametrize(("spoil", "name", "within_ticks"), LATCHING)
def test_a_fault_is_noticed_in_time_fades_to_zero_and_latches(
    spoil: Callable[[Bench], None], name: str, within_ticks: int
) -> None:
    bench = Bench().active()
    spoil(bench)
    bench.run(within_ticks)
    assert bench.state is State.FAULT
    assert bench.alarm == BY_NAME[name].code
    assert bench.bits & StateBits.FAULT
    assert not bench.bits & StateBits.ACTIVE
    bench.run(FADE_TICKS)
    assert bench.out == (0.0, 0.0)
    assert not bench.bits & StateBits.FADING
    assert name in bench.codes()


@pytest.mark.parametrize(("spoil", "name", "within_ticks"), LATCHING)
def test_after_a_fault_only_the_operator_brings_the_output_back(
    spoil: Callable[[Bench], None], name: str, within_ticks: int
) -> None:
    bench = Bench().active()
    spoil(bench)
    bench.run(within_ticks + FADE_TICKS)
    heal(bench)
    bench.run_s(2.0)
    assert bench.state is State.FAULT
    assert bench.alarm == BY_NAME[name].code
    assert bench.out == (0.0, 0.0)
    bench.guard.arm()
    bench.run_s(0.5)
    assert bench.state is State.ACTIVE
    assert bench.out == (STEP.value, STEP.value)


def heal(b: Bench) -> None:
    b.outcome = Outcome.OK
    b.heartbeat_moves = b.tension_moves = b.supervisor_alive = True
    b.tension_N, b.speed_m_s, b.radius_m = 90.0, 1.0, 0.2
    b.overrun = False
    b.steps = (STEP, STEP)


def test_a_correction_fades_without_a_step() -> None:
    bench = Bench().active()
    bench.outcome = Outcome.TIMEOUT
    before = bench.out[0]
    steepest = 1.5708 * STEP.value * PERIOD_S / FADE_S
    for _ in range(FAULT_TICKS + FADE_TICKS + 2):
        bench.run()
        assert before - bench.out[0] <= steepest
        before = bench.out[0]
    assert before == 0.0


def test_the_first_cause_stays_on_the_alarm_word() -> None:
    bench = Bench().active()
    bench.tension_N = nan
    bench.run()
    bench.outcome = Outcome.TIMEOUT
    bench.run(50)
    assert bench.alarm == BY_NAME["TENSION_IMPLAUSIBLE"].code
    assert bench.guard.first_blocking().startswith("blocked by PLC_STALE")


# --- permissives, splice, hold --------------------


@pytest.mark.parametrize(
    "missing", [Status.LINE_RUN, Status.WEB_INTACT, Status.TENSION_VALID, Status.ESTOP_OK]
)
def test_a_lost_permissive_fades_and_comes_back_by_itself(missing: Status) -> None:
    bench = Bench().active()
    bench.clear(missing)
    bench.run()
    assert bench.state is State.FADING
    assert bench.alarm == BY_NAME["PERMISSIVE_LOST"].code
    bench.run(FADE_TICKS)
    assert bench.out == (0.0, 0.0)
    assert bench.state is State.OFF
    assert bench.bits & StateBits.ARMED
    assert not bench.bits & StateBits.READY
    assert bench.guard.first_blocking() == f"blocked by {missing.name}=0"
    bench.set(missing)
    bench.run_s(0.5)
    assert bench.state is State.ACTIVE
    assert bench.codes() == ["PERMISSIVE_LOST"]


def test_a_permissive_that_blinks_still_fades_to_zero_before_the_soft_start() -> None:
    bench = Bench().active()
    bench.clear(Status.WEB_INTACT)
    bench.run()
    bench.set(Status.WEB_INTACT)
    bench.run(FADE_TICKS - 1)
    assert bench.out == (0.0, 0.0)
    bench.run_s(0.5)
    assert bench.state is State.ACTIVE


def test_an_unarmed_guard_follows_the_permissives_and_does_not_open() -> None:
    bench = Bench()
    bench.clear(Status.LINE_RUN)
    bench.run()
    bench.guard.arm()
    bench.run()
    assert bench.state is State.OFF
    bench.set(Status.LINE_RUN)
    bench.run(200)
    assert bench.state is State.READY
    assert bench.out == (0.0, 0.0)
    assert bench.bits == StateBits.READY


def test_a_splice_fades_and_the_new_radius_is_no_jump() -> None:
    bench = Bench().active()
    bench.roll_id = 2
    bench.run()
    assert bench.state is State.FADING
    assert bench.alarm == BY_NAME["SPLICE"].code
    bench.radius_m = 0.4
    bench.run_s(1.0)
    assert bench.state is State.ACTIVE
    assert bench.codes() == ["SPLICE"]


def test_young_silence_freezes_adaptation_and_keeps_the_output() -> None:
    bench = Bench().active()
    assert bench.permission is not None
    assert bench.permission.adapt
    bench.heartbeat_moves = False
    bench.run(3)
    assert bench.permission.adapt
    bench.run()
    assert not bench.permission.adapt
    assert bench.bits & StateBits.COMM_WARN
    assert bench.out == (STEP.value, STEP.value)
    bench.heartbeat_moves = True
    bench.run()
    assert bench.permission.adapt
    assert bench.state is State.ACTIVE


def test_nothing_adapts_on_a_lost_transaction() -> None:
    bench = Bench().active()
    bench.outcome = Outcome.BAD_REPLY
    bench.run()
    assert bench.permission is not None
    assert not bench.permission.adapt


def test_objections_leave_an_open_output_alone_but_keep_a_closed_one_closed() -> None:
    bench = Bench().active()
    bench.guard.objections = ("phase unsure",)
    bench.run(10)
    assert bench.state is State.ACTIVE
    bench.speed_m_s = 0.0
    bench.run(FADE_TICKS + 2)
    bench.speed_m_s = 1.0
    bench.run(50)
    assert bench.state is State.OFF
    bench.guard.objections = ()
    bench.run(2)
    assert bench.state is State.ACTIVE


# --- operator --------------------


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
    for _ in range(FADE_TICKS):
        bench.run()
        outputs.append(bench.out[0])
    assert 0.0 in outputs
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


# --- limits and settings --------------------


def test_a_wish_beyond_the_limit_is_scaled_and_told_to_law_and_plc() -> None:
    bench = Bench()
    bench.steps = (ActuatorStep(value=0.2, peak_bound=0.2, slew_bound=0.1), STEP)
    bench.arm()
    bench.run_s(1.0)
    assert bench.out[0] == pytest.approx(0.05)
    assert bench.bits & StateBits.SATURATED
    assert bench.permission is not None
    assert bench.permission.limit_ratio == (pytest.approx(0.25), 1.0)
    assert bench.permission.applied_ratio == (pytest.approx(0.25), 1.0)
    assert bench.guard.limits == (0.05, 0.02)


def test_new_settings_are_taken_while_active_without_a_step() -> None:
    bench = Bench().active()
    smaller = replace(PARAMS.actuators[0], limit=0.004)
    assert bench.guard.adopt(replace(PARAMS, actuators=(smaller, PARAMS.actuators[1])))
    before = bench.out[0]
    while abs(bench.out[0]) > 0.004:
        bench.run()
        assert 0.0 <= before - bench.out[0] <= 2.0 * PERIOD_S
        before = bench.out[0]
    assert bench.state is State.ACTIVE
    bench.run(100)
    assert bench.out[0] == pytest.approx(0.004 * STEP.value / STEP.peak_bound)
    assert bench.guard.limits[0] == 0.004


def test_settings_with_other_outputs_are_refused() -> None:
    bench = Bench().active()
    assert not bench.guard.adopt(replace(PARAMS, actuators=PARAMS.actuators[:1]))
    bench.run()
    assert bench.out == (STEP.value, STEP.value)


def test_one_fade_on_request_reaches_zero_and_comes_back() -> None:
    bench = Bench().active()
    bench.guard.fade_once()
    bench.run(FADE_TICKS)
    assert bench.out == (0.0, 0.0)
    bench.run_s(0.5)
    assert bench.state is State.ACTIVE
    assert bench.codes() == []


@pytest.mark.parametrize("dt_s", [nan, -1.0, 0.0])
def test_a_senseless_period_moves_nothing(dt_s: float) -> None:
    bench = Bench().active()
    corrections, _, _ = bench.guard.limit(bench.steps, dt_s)
    assert corrections == (STEP.value, STEP.value)
