from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import nan

import pytest

from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import Outcome, State, StateBits
from aff_runtime.safety.params import AppliedParams
from tests.aff_runtime.safety.bench import FADE_S, PARAMS, PERIOD_NS, PERIOD_S, STEP, Bench
from tests.each_case import each_case

FADE_TICKS = round(FADE_S / PERIOD_S)
FAULT_TICKS = round(PARAMS.freshness.fault_after_s / PERIOD_S)
STUCK_TICKS = round(PARAMS.channels[0].stuck_after_s / PERIOD_S)


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


def another_master(b: Bench) -> None:
    b.echo_age = 30_000


LATCHING = [
    (another_master, "SECOND_MASTER", 3),
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


@each_case(("spoil", "name", "within_ticks"), LATCHING)
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
    bench.run(3)
    assert not bench.bits & StateBits.FADING
    assert name in bench.codes()


def test_the_plc_is_told_zero_before_the_fading_bit_goes() -> None:
    # without the bit the PLC takes no correction and would ramp down from the last one it took
    bench = Bench().active()
    bench.guard.internal_fault()
    told = []
    for _ in range(FADE_TICKS + 10):
        bench.run(1)
        told.append((bench.out == (0.0, 0.0), bool(bench.bits & StateBits.FADING)))
    assert told.count((True, True)) == 3
    assert told.count((False, False)) == 0


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
    b.echo_age = 1
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


SHOWN = replace(
    PARAMS, applied=AppliedParams(tolerances=(2e-5, None), units=("m/s", "m/s"), ticks=50)
)


def following(b: Bench, ticks: int) -> None:
    """Run with a PLC that applies what went out in the tick before."""
    for _ in range(ticks):
        b.applied = (b.out[0], nan)
        b.run()


def test_what_the_plc_applies_and_we_did_not_send_fades_latches_and_is_named() -> None:
    bench = Bench(SHOWN)
    following(bench, 2)
    assert bench.guard.arm() == ""
    following(bench, 60)
    assert bench.state is State.ACTIVE
    assert bench.out[0] == STEP.value
    bench.applied = (0.02, nan)
    bench.run(3)
    assert bench.state is State.FAULT
    assert bench.alarm == BY_NAME["APPLIED_DIFFERS"].code
    assert bench.guard.first_blocking() == (
        "blocked by APPLIED_DIFFERS (unwind: 0.02 m/s applied, 0.01 sent)"
    )
    bench.run(FADE_TICKS)
    assert bench.out == (0.0, 0.0)
    bench.guard.arm()
    bench.run(10)
    assert bench.state is State.FAULT  # nobody arms while it lasts
    bench.applied = (0.0, nan)
    bench.run_s(2.0)
    assert bench.state is State.FAULT
    assert bench.guard.first_blocking() == ""
    bench.guard.arm()
    following(bench, 100)
    assert bench.state is State.ACTIVE
    assert bench.codes().count("APPLIED_DIFFERS") == 1


@pytest.mark.parametrize("rest", [State.BYPASS, State.FAULT])
def test_it_is_the_alarm_of_a_guard_at_rest_while_it_lasts(rest: State) -> None:
    bench = Bench(SHOWN)
    following(bench, 20)
    if rest is State.BYPASS:
        bench.guard.bypass()
    else:
        bench.overrun = True
    following(bench, 2)
    bench.overrun = False
    following(bench, 20)
    assert bench.state is rest
    before = bench.alarm
    assert before != BY_NAME["APPLIED_DIFFERS"].code
    bench.guard.drain_events()
    bench.applied = (0.02, nan)
    bench.run(3)
    assert (bench.state, bench.alarm) == (rest, BY_NAME["APPLIED_DIFFERS"].code)
    assert bench.codes() == ["APPLIED_DIFFERS"]
    assert bench.out == (0.0, 0.0)
    bench.guard.arm()
    bench.run(10)
    assert bench.state is rest
    bench.applied = (0.0, nan)
    bench.run_s(1.0)
    assert (bench.state, bench.alarm) == (rest, before)


def test_new_settings_between_two_ticks_accuse_nobody() -> None:
    bench = Bench(SHOWN)
    following(bench, 2)
    bench.guard.arm()
    following(bench, 60)
    for limit in (0.004, 0.05, 0.001):
        actuators = (replace(PARAMS.actuators[0], limit=limit), PARAMS.actuators[1])
        assert bench.guard.adopt(replace(SHOWN, actuators=actuators))
        following(bench, 100)
    assert bench.state is State.ACTIVE
    assert "APPLIED_DIFFERS" not in bench.codes()
