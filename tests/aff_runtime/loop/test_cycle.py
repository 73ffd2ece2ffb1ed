from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from math import isnan, nan

import pytest

from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import ActuatorStep, Outcome, State, StateBits
from aff_runtime.loop.messages import Arm, Bypass
from tests.aff_runtime.loop.rig import COLUMNS, FADE_TICKS, PERIOD_NS, Rig

INTERNAL_FAULT = BY_NAME["INTERNAL_FAULT"].code


def heartbeats_go_on(rig: Rig, since: int) -> None:
    beats = [command.heartbeat for _, command in rig.plc.commands[since:]]
    assert beats == list(range(beats[0], beats[0] + len(beats)))


def test_one_transaction_per_tick_on_the_grid_with_a_deadline() -> None:
    rig = Rig()
    rig.run(50)
    times = [t_ns for t_ns, _ in rig.plc.commands]
    assert times == [10**9 + (k + 1) * PERIOD_NS for k in range(50)]
    assert rig.plc.deadlines == [3_000_000] * 50


def test_the_first_commands_are_zero_in_fault_with_heartbeat_echo_and_revision() -> None:
    rig = Rig()
    rig.run(5)
    for k, (_, command) in enumerate(rig.plc.commands):
        assert command.heartbeat == k + 1
        assert command.echo == k
        assert command.corrections == (0.0,)
        assert command.state_bits & StateBits.FAULT
        assert command.alarm == BY_NAME["POWER_UP"].code
        assert command.config_revision == 0x2345
    assert rig.plc.last.limits == (0.05,)


def test_heartbeat_wraps_as_a_word() -> None:
    rig = Rig()
    rig.cycle._tick = 0xFFFE
    rig.run(3)
    assert [command.heartbeat for _, command in rig.plc.commands] == [0xFFFF, 0, 1]


def test_heartbeats_begin_after_the_first_one_that_the_settings_name() -> None:
    rig = Rig()
    rig.cycle._settings = replace(rig.cycle._settings, first_heartbeat=0xFFFE)
    rig.run(3)
    assert [command.heartbeat for _, command in rig.plc.commands] == [0xFFFF, 0, 1]
    assert rig.cycle._tick == 3


def test_armed_it_sends_what_the_law_wants_one_tick_later() -> None:
    rig = Rig().active()
    rig.run(50)
    wanted = rig.column("wanted_unwind_m_s")
    sent = [command.corrections[0] for _, command in rig.plc.commands]
    assert sent[-40:] == pytest.approx(wanted[-41:-1])


def test_records_have_a_value_per_column_and_exact_time() -> None:
    rig = Rig().active()
    assert all(len(record) == len(COLUMNS) for record in rig.memory.records)
    ticks = len(rig.memory.records)
    assert rig.column("time_s") == pytest.approx([0.005 * (k + 1) for k in range(ticks)])
    assert rig.column("state")[-1] == State.ACTIVE
    assert rig.column("io_us") == [300.0] * ticks
    assert rig.column("law_k") == list(range(1, ticks + 1))
    assert rig.memory.ticks_done == ticks


def test_a_law_that_raises_once_fades_to_zero_and_needs_the_operator() -> None:
    rig = Rig().active()
    first = len(rig.plc.commands)
    rig.law.trouble = ZeroDivisionError("weights")
    rig.run(1)
    rig.law.trouble = None
    rig.run(100)
    rig.assert_faded_from(first)
    heartbeats_go_on(rig, first)
    assert rig.plc.last.alarm == INTERNAL_FAULT
    assert "ZeroDivisionError: weights" in rig.memory.faults[0]
    assert rig.memory.events == ["INTERNAL_FAULT"]
    rig.say(Arm())
    rig.run(30)
    assert rig.guard.state is State.ACTIVE


def test_a_law_that_always_raises_is_told_once_and_cannot_be_armed() -> None:
    rig = Rig().active()
    first = len(rig.plc.commands)
    rig.law.trouble = RuntimeError("again")
    rig.run(60)
    rig.say(Arm())
    rig.run(60)
    rig.assert_faded_from(first)
    heartbeats_go_on(rig, first)
    assert len(rig.memory.faults) == 1
    assert isnan(rig.column("wanted_unwind_m_s")[-1])


@pytest.mark.parametrize("value", [nan, float("inf"), -float("inf")])
def test_a_law_that_returns_no_number_fades_to_zero(value: float) -> None:
    rig = Rig().active()
    first = len(rig.plc.commands)
    rig.law.value = value
    rig.run(100)
    rig.assert_faded_from(first)
    assert rig.plc.last.alarm == INTERNAL_FAULT


@pytest.mark.parametrize("bad", [None, (), ("not a step",), 7])
def test_a_law_that_returns_something_else_fades_to_zero(
    bad: object, monkeypatch: pytest.MonkeyPatch
) -> None:
    rig = Rig().active()
    first = len(rig.plc.commands)
    monkeypatch.setattr(rig.law, "step", lambda *_: bad)
    rig.run(100)
    later = rig.plc.commands[first + FADE_TICKS + 6 :]
    assert all(command.corrections == (0.0,) for _, command in later)
    assert rig.plc.last.alarm in (INTERNAL_FAULT, BY_NAME["LEASE_EXPIRED"].code)
    heartbeats_go_on(rig, first)


def test_a_law_that_hangs_once_for_long_fades_and_latches() -> None:
    rig = Rig().active()
    rig.law.clock, rig.law.hang_ns = rig.clock, 30 * PERIOD_NS
    rig.run(1)
    rig.law.hang_ns = 0
    rig.run(FADE_TICKS + 2)
    assert rig.plc.last.corrections == (0.0,)
    assert rig.plc.last.alarm == BY_NAME["OVERRUN"].code


def test_three_late_ticks_in_a_row_are_an_overrun_and_two_are_not() -> None:
    rig = Rig().active()
    rig.law.clock, rig.law.hang_ns = rig.clock, 5_000_000
    rig.run(2)
    rig.law.hang_ns = 0
    rig.run(5)
    assert rig.guard.state is State.ACTIVE
    rig.law.hang_ns = 5_000_000
    rig.run(5)
    assert rig.guard.state is State.FAULT
    assert rig.plc.last.alarm == BY_NAME["OVERRUN"].code
    assert "OVERRUN" in rig.memory.events


def test_skipped_ticks_reach_the_law_as_whole_periods() -> None:
    rig = Rig().active()
    rig.law.clock, rig.law.hang_ns = rig.clock, 4 * PERIOD_NS
    rig.run(1)
    rig.law.hang_ns = 0
    rig.run(2)
    assert rig.law.dt_s[-2:] == pytest.approx([0.020, 0.005])
    assert rig.column("periods_count")[-2:] == [4, 1]
    assert rig.column("missed_count")[-1] == 3


def test_a_gateway_that_raises_is_an_internal_fault_and_the_output_ends_at_zero() -> None:
    rig = Rig().active()
    rig.plc.raises = OSError("wire")
    rig.run(FADE_TICKS + 1)
    rig.plc.raises = None
    rig.run(2)
    assert rig.plc.last.corrections == (0.0,)
    assert rig.plc.last.state_bits & StateBits.FAULT


def test_a_mute_plc_is_met_with_zero_and_heartbeats() -> None:
    rig = Rig().active()
    first = len(rig.plc.commands)
    rig.plc.outcome = Outcome.TIMEOUT
    rig.run(16 + FADE_TICKS + 2)
    assert rig.plc.last.corrections == (0.0,)
    assert rig.plc.last.alarm == BY_NAME["PLC_STALE"].code
    heartbeats_go_on(rig, first)


def test_a_recorder_that_raises_fades_the_output_and_bypass_still_works() -> None:
    rig = Rig().active()
    first = len(rig.plc.commands)
    rig.memory.publish_trouble = BufferError("ring")
    rig.say(Bypass())
    rig.run(60)
    heartbeats_go_on(rig, first)
    assert rig.plc.last.corrections == (0.0,)
    assert rig.guard.state is State.BYPASS


def test_a_broken_guard_is_replaced_by_a_straight_ramp_to_zero_for_good(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rig = Rig().active()
    first = len(rig.plc.commands)
    start = rig.plc.last.corrections[0]

    def broken(steps: tuple[ActuatorStep, ...] | None, dt_s: float) -> None:
        raise IndexError("guard")

    monkeypatch.setattr(rig.guard, "limit", broken)
    rig.run(60)
    monkeypatch.undo()
    rig.run(60)
    sent = [command.corrections[0] for _, command in rig.plc.commands[first:]]
    steps = [a - b for a, b in pairwise(sent)]
    assert max(steps) <= 1.01 * start / FADE_TICKS
    rig.assert_faded_from(first)
    assert rig.plc.last.alarm == INTERNAL_FAULT
    assert not rig.plc.last.state_bits & StateBits.FADING
    heartbeats_go_on(rig, first)


def test_a_link_that_fails_while_a_fault_is_told_still_ends_in_zero(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rig = Rig().active()
    first = len(rig.plc.commands)

    def deaf(text: str) -> None:
        raise BrokenPipeError

    monkeypatch.setattr(rig.memory, "fault_text", deaf)
    rig.law.trouble = RuntimeError("law")
    rig.run(60)
    rig.assert_faded_from(first)
    heartbeats_go_on(rig, first)


def test_a_link_that_fails_while_a_fault_is_told_does_not_cost_the_guard(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rig = Rig().active()

    def deaf(text: str) -> None:
        raise BrokenPipeError

    monkeypatch.setattr(rig.memory, "fault_text", deaf)
    rig.law.trouble = RuntimeError("law")
    rig.run(FADE_TICKS + 5)
    assert rig.guard.state is State.FAULT
    assert rig.plc.last.corrections == (0.0,)
    rig.law.trouble, rig.law.value = None, 0.008
    rig.run(2)
    rig.say(Arm())
    rig.run(30)
    assert rig.guard.state is State.ACTIVE
    assert rig.plc.last.state_bits & StateBits.ACTIVE
    assert rig.plc.last.corrections[0] == pytest.approx(0.008)


def test_a_guard_that_cannot_latch_a_fault_is_replaced_by_the_ramp(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rig = Rig().active()
    first = len(rig.plc.commands)

    def broken() -> None:
        raise IndexError("guard")

    monkeypatch.setattr(rig.guard, "internal_fault", broken)
    rig.law.trouble = RuntimeError("law")
    rig.run(60)
    rig.assert_faded_from(first)
    assert "IndexError" not in rig.memory.faults[0]
    assert "RuntimeError: law" in rig.memory.faults[0]
    rig.law.trouble = None
    rig.say(Arm())
    rig.run(60)
    rig.assert_faded_from(first)
    heartbeats_go_on(rig, first)


def test_an_operator_interrupt_is_not_swallowed(monkeypatch: pytest.MonkeyPatch) -> None:
    rig = Rig().active()
    rig.law.trouble = KeyboardInterrupt()  # type: ignore[assignment]
    with pytest.raises(KeyboardInterrupt):
        rig.run(1)


def hold_up(rig: Rig, stall_ms: int, where: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Do one tick after a stall in the work of the tick before, or in the sleep before it."""
    sleep = rig.clock.sleep_until_ns
    with monkeypatch.context() as stopped:
        if where == "work":
            rig.clock.advance_ns(stall_ms * 1_000_000)
        else:
            stopped.setattr(
                rig.clock, "sleep_until_ns", lambda at_ns: sleep(at_ns + stall_ms * 1_000_000)
            )
        rig.run(1)


@pytest.mark.parametrize("stall_ms", [85, 100, 140, 1000])  # the fade takes 150
@pytest.mark.parametrize("where", ["work", "sleep"])
def test_after_a_stall_a_zero_goes_out_and_nothing_rises_again(
    where: str, stall_ms: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    rig = Rig().active()
    before = len(rig.plc.commands)
    hold_up(rig, stall_ms, where, monkeypatch)
    rig.run(FADE_TICKS + 5)
    first = rig.plc.commands[before][1]
    assert all(command.corrections == (0.0,) for _, command in rig.plc.commands[before:])
    assert first.alarm == BY_NAME["OVERRUN"].code
    assert first.state_bits == StateBits.FAULT  # neither ACTIVE and FADING nor READY and ARMED
    assert rig.plc.commands[before + 1][1].state_bits == StateBits.FAULT | StateBits.FADING
    assert rig.guard.state is State.FAULT
    assert rig.memory.events == ["OVERRUN"]
    rig.law.value = 0.01
    rig.say(Arm())
    rig.run(30)
    opening = [command.corrections[0] for _, command in rig.plc.commands[before:]]
    steepest = 0.5 * math.pi * 0.01 / 0.05  # of a raised cosine of 10 mm/s in 50 ms, m/s2
    assert max(b - a for a, b in pairwise(opening)) <= steepest * 0.005 + 1e-6
    assert opening[-1] > 0.009


@pytest.mark.parametrize("broken", ["limit", "withdraw"])
def test_without_a_guard_too_nothing_rises_again_after_a_stall(
    broken: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    rig = Rig().active()

    def fails(*_: object) -> None:
        raise IndexError("guard")

    monkeypatch.setattr(rig.guard, broken, fails)
    if broken == "limit":
        rig.run(3)
    before = len(rig.plc.commands)
    hold_up(rig, 100, "work", monkeypatch)
    rig.run(FADE_TICKS + 5)
    assert all(command.corrections == (0.0,) for _, command in rig.plc.commands[before:])
