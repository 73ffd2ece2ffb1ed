"""Who may arm: the operator's word in local, the PLC's reset in remote."""

from __future__ import annotations

from aff_runtime.base.signals import Outcome, State, Status
from tests.aff_runtime.safety.bench import PARAMS, PERIOD_S, Bench

FAULT_TICKS = round(PARAMS.freshness.fault_after_s / PERIOD_S)


def remote() -> Bench:
    bench = Bench()
    bench.set(Status.REMOTE)
    bench.run(5)
    return bench


def press(bench: Bench, ticks: int = 5) -> None:
    bench.set(Status.RESET_EDGE)
    bench.run(ticks)
    bench.clear(Status.RESET_EDGE)


def test_in_remote_a_rising_reset_arms() -> None:
    bench = remote()
    press(bench)
    assert bench.state is State.ACTIVE


def test_in_local_a_reset_of_the_plc_means_nothing() -> None:
    bench = Bench()
    bench.run(5)
    press(bench)
    assert bench.state is State.FAULT
    assert bench.guard.arm() == ""
    bench.run()
    assert bench.state is State.ACTIVE


def test_in_remote_the_word_of_anybody_else_is_refused_with_the_reason() -> None:
    bench = remote()
    assert bench.guard.arm() == "blocked by REMOTE=1: the PLC arms, by its reset"
    bench.run(100)
    assert bench.state is State.FAULT
    press(bench)
    assert bench.guard.first_blocking() == ""


def test_in_remote_anybody_may_bypass_and_only_a_new_reset_returns() -> None:
    bench = remote()
    bench.set(Status.RESET_EDGE)
    bench.run(60)
    bench.guard.bypass()
    bench.run(100)
    assert bench.state is State.BYPASS
    bench.clear(Status.RESET_EDGE)
    bench.run(2)
    press(bench)
    assert bench.state is State.ACTIVE


def test_a_reset_that_is_high_from_the_start_is_no_edge() -> None:
    bench = Bench()
    bench.set(Status.REMOTE | Status.RESET_EDGE)
    bench.run(100)
    assert bench.state is State.FAULT


def test_a_reset_that_rises_while_nobody_sees_it_is_no_edge() -> None:
    bench = remote()
    bench.outcome = Outcome.TIMEOUT
    bench.run(FAULT_TICKS + 2)
    bench.set(Status.RESET_EDGE)
    bench.outcome = Outcome.OK
    bench.run(50)
    assert bench.state is State.FAULT


def test_switching_to_remote_under_a_high_reset_arms_nothing() -> None:
    bench = Bench()
    bench.run(5)
    bench.set(Status.RESET_EDGE)
    bench.run(5)
    bench.set(Status.REMOTE)
    bench.run(50)
    assert bench.state is State.FAULT


def test_a_reset_does_not_pass_a_present_cause() -> None:
    bench = remote()
    bench.supervisor_alive = False
    bench.run()
    press(bench)
    bench.supervisor_alive = True
    bench.run(50)
    assert bench.state is State.FAULT


def test_one_reset_accepts_another_roll_as_one_press_in_local_does() -> None:
    bench = remote()
    press(bench)
    bench.run_s(0.3)
    bench.radius_m = 0.3
    bench.run_s(0.3)
    assert bench.state is State.FAULT
    assert bench.guard.first_blocking().startswith("blocked by RADIUS_JUMP")
    press(bench)
    assert bench.state is State.ACTIVE
    assert bench.guard.first_blocking() == ""


def test_what_was_armed_in_local_stays_when_the_line_goes_to_remote() -> None:
    bench = Bench().active()
    bench.set(Status.REMOTE)
    bench.run(20)
    assert bench.state is State.ACTIVE
    assert bench.guard.first_blocking() == ""
