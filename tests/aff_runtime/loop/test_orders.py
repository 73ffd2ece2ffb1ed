from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import pytest

from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import State, StateBits
from aff_runtime.loop.messages import Arm, Bypass, Shadow, Stop, SupervisorLost, Swap
from aff_runtime.loop.ports import Advice
from tests.aff_runtime.loop.rig import FADE_TICKS, PARAMS, Hum, Rig


class Heir(Hum):
    """Goes on where the old law stands."""

    def take_over(self, old: Hum) -> None:
        self.k = old.k


def biggest_move(rig: Rig, since: int) -> float:
    sent = [command.corrections[0] for _, command in rig.plc.commands[since:]]
    return max(abs(b - a) for a, b in pairwise(sent))


def run_to_the_end(rig: Rig) -> None:
    for _ in range(200):
        if not rig.cycle.tick():
            return
    raise AssertionError("the cycle did not end")


def test_bypass_reaches_the_wire_with_the_next_command() -> None:
    rig = Rig().active()
    rig.say(Bypass())
    rig.run(2)
    assert rig.guard.state is State.BYPASS
    rig.run(FADE_TICKS)
    assert rig.plc.last.corrections == (0.0,)


def test_stop_fades_sends_zeros_and_ends() -> None:
    rig = Rig().active()
    first = len(rig.plc.commands)
    rig.say(Stop())
    run_to_the_end(rig)
    sent = [command.corrections[0] for _, command in rig.plc.commands[first:]]
    assert sent[-5:] == [0.0] * 5
    assert sent[2] > 0.0
    assert biggest_move(rig, first) < 0.001
    assert len(sent) <= FADE_TICKS + 10


def test_a_signal_stops_like_a_message_even_when_the_link_fails(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rig = Rig().active()

    def broken() -> list[object]:
        raise ConnectionResetError

    monkeypatch.setattr(rig.memory, "poll", broken)
    rig.cycle.request_stop()
    run_to_the_end(rig)
    assert rig.plc.last.corrections == (0.0,)


def test_a_lost_supervisor_latches_fades_and_ends() -> None:
    rig = Rig().active()
    rig.say(SupervisorLost())
    run_to_the_end(rig)
    assert rig.plc.last.corrections == (0.0,)
    assert rig.plc.last.alarm == BY_NAME["SUPERVISOR_LOST"].code
    assert rig.plc.last.state_bits & StateBits.FAULT


def test_nothing_can_be_armed_on_the_way_down() -> None:
    rig = Rig()
    rig.run(2)
    rig.say(Stop(), Arm(), Shadow(on=True), Swap(law=Hum(0.04)))
    rig.run(2)
    rig.say(Arm())
    run_to_the_end(rig)
    assert rig.guard.state is State.BYPASS
    assert rig.column("state").count(State.ACTIVE) == 0
    assert all(command.corrections == (0.0,) for _, command in rig.plc.commands)


def test_run_returns_after_a_stop_and_starts_its_grid_late_without_missed_ticks() -> None:
    rig = Rig()
    rig.clock.advance_ns(10**9)
    rig.cycle.request_stop()
    rig.cycle.run()
    assert rig.column("missed_count")[-1] == 0
    assert rig.plc.last.corrections == (0.0,)


def test_a_law_that_takes_over_changes_places_without_a_step() -> None:
    rig = Rig().active()
    rig.run(50)
    first = len(rig.plc.commands) - 1
    rig.say(Swap(law=Heir(0.0101), config_revision=7))
    rig.run(50)
    assert rig.guard.state is State.ACTIVE
    assert biggest_move(rig, first) < 2.5e-4  # 0.0001 more amplitude, 2 * 0.01 / s of slope
    assert rig.plc.last.config_revision == 7


def test_a_law_that_cannot_take_over_waits_for_zero_and_comes_back_softly() -> None:
    rig = Rig().active()
    rig.run(50)
    first = len(rig.plc.commands) - 1
    new = Hum(-0.02)
    rig.say(Swap(law=new))
    rig.run(FADE_TICKS + 40)
    assert new.k > 0
    assert rig.guard.state is State.ACTIVE
    assert rig.plc.last.corrections[0] < -0.015
    sent = [command.corrections[0] for _, command in rig.plc.commands[first:]]
    assert 0.0 in sent
    assert biggest_move(rig, first) < 0.02 * 1.5708 * 0.005 / 0.05 + 1e-4


def test_a_swap_while_quiet_happens_at_once() -> None:
    rig = Rig()
    rig.run(2)
    new = Hum()
    rig.say(Swap(law=new))
    rig.run(2)
    assert new.k == 1


def test_a_take_over_that_fails_keeps_the_old_law_and_fades() -> None:
    rig = Rig().active()

    def refuse(old: object) -> None:
        raise TypeError("other kind of law")

    rig.say(Swap(law=Hum(), take_over=refuse))
    before = rig.law.k
    rig.run(FADE_TICKS + 2)
    assert rig.law.k == before + FADE_TICKS + 2
    assert rig.guard.state is State.FAULT
    assert rig.plc.last.corrections == (0.0,)


def test_a_message_that_fails_does_not_take_the_bypass_behind_it_along() -> None:
    rig = Rig().active()
    rig.say(Swap(guard_params="nonsense"), Bypass())
    rig.run(3)
    assert rig.guard.state is State.BYPASS


def test_new_limits_are_handed_to_the_guard() -> None:
    rig = Rig().active()
    limits = replace(PARAMS.actuators[0], limit=0.002)
    rig.say(Swap(guard_params=replace(PARAMS, actuators=(limits,))))
    rig.run(100)
    assert rig.plc.last.limits == (0.002,)
    assert abs(rig.plc.last.corrections[0]) <= 0.002


def test_objections_of_the_law_side_are_asked_before_arming_and_told() -> None:
    rig = Rig()
    rig.run(2)
    rig.memory.advice = Advice(objections=("no response measured",))
    rig.say(Arm())
    rig.run(30)
    assert rig.plc.last.corrections == (0.0,)
    assert rig.guard.state is State.OFF
    assert rig.memory.reasons[-1] == ("no response measured",)


def test_ripple_that_rose_latches_within_the_advice_interval() -> None:
    rig = Rig().active()
    rig.memory.advice = Advice(ripple_rose=True)
    rig.run(22)
    assert rig.guard.state is State.FAULT
    assert "RIPPLE_ROSE" in rig.memory.events


def test_shadow_computes_records_and_sends_zero() -> None:
    rig = Rig().active()
    rig.say(Shadow(on=True))
    rig.run(FADE_TICKS + 5)
    assert rig.plc.last.corrections == (0.0,)
    assert abs(rig.column("wanted_unwind_m_s")[-1]) > 0.0
    assert rig.column("state")[-1] == State.SHADOW
