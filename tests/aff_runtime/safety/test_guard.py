from __future__ import annotations

from dataclasses import replace
from math import nan

import pytest

from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import ActuatorStep, Outcome, State, StateBits, Status
from tests.aff_runtime.safety.bench import FADE_S, PARAMS, PERIOD_S, STEP, Bench

FADE_TICKS = round(FADE_S / PERIOD_S)
FAULT_TICKS = round(PARAMS.freshness.fault_after_s / PERIOD_S)
STUCK_TICKS = round(PARAMS.channels[0].stuck_after_s / PERIOD_S)


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
