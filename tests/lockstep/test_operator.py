"""Bypass from every state of the guard, on the real line, judged at the plant."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from dataclasses import replace

import pytest

from aff_runtime.base.signals import State, Status
from aff_runtime.loop.messages import Arm, Bypass, Shadow, Swap
from tests.lockstep.bench import Bench, Setup
from tests.lockstep.fault_table import WORKING_M_S, ZERO_WITHIN_S, peak, zero_after_s
from tests.lockstep.works_again import assert_works_again


def _fault(bench: Bench) -> None:
    bench.inject("freeze:0.3")
    bench.run(0.5)


def _off(bench: Bench) -> None:
    bench.plant.plc.set_status(Status.WEB_INTACT, False)
    bench.run(0.5)


def _ready(bench: Bench) -> None:
    bench.say(Shadow(on=True))
    bench.run(0.5)
    bench.say(Shadow(on=False))
    bench.run(0.1)


def _armed(bench: Bench) -> None:
    waits = tuple(replace(a, active_above_m_s=5.0) for a in bench.params.actuators)
    bench.say(Swap(guard_params=replace(bench.params, actuators=waits)))
    bench.run(0.5)


def _active(bench: Bench) -> None:
    assert peak(bench.applied, bench.now_s - 0.3, bench.now_s) > WORKING_M_S


def _fading(bench: Bench) -> None:
    bench.plant.plc.set_status(Status.LINE_RUN, False)
    bench.run(0.04)


def _bypass(bench: Bench) -> None:
    bench.say(Bypass())
    bench.run(0.5)


def _shadow(bench: Bench) -> None:
    bench.say(Shadow(on=True))
    bench.run(0.5)


WAYS: dict[State, Callable[[Bench], None]] = {
    State.FAULT: _fault,
    State.OFF: _off,
    State.READY: _ready,
    State.ARMED: _armed,
    State.ACTIVE: _active,
    State.FADING: _fading,
    State.BYPASS: _bypass,
    State.SHADOW: _shadow,
}


def test_there_is_a_way_into_every_state():
    assert set(WAYS) == set(State)


@pytest.fixture(scope="module")
def working(responses) -> Bench:
    bench = Bench(Setup(responses=responses))
    bench.run(0.5)
    bench.arm(2.0)
    return bench


@pytest.mark.parametrize("state", WAYS)
def test_bypass_works_in_every_state_and_needs_an_edge_to_end(working: Bench, state: State):
    bench = deepcopy(working)
    WAYS[state](bench)
    assert bench.guard.state is state
    pressed_s = bench.now_s
    bench.say(Bypass())
    bench.run(0.05)
    assert bench.guard.state is State.BYPASS
    bench.plant.plc.status = bench.plant.plc.status | Status.WEB_INTACT | Status.LINE_RUN
    bench.run(1.5)
    assert bench.guard.state is State.BYPASS
    assert zero_after_s(bench.applied, pressed_s) < ZERO_WITHIN_S
    bench.say(Swap(guard_params=bench.params))
    bench.say(Shadow(on=False))
    bench.run(0.1)
    bench.say(Arm())
    assert_works_again(bench, 1.5)
