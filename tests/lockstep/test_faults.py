"""Every fault of the table against the real line, in virtual time, judged at the plant."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from dataclasses import replace
from pathlib import Path

import pytest

from aff_runtime.app.wiring.site_to_wire import register_map
from aff_runtime.base.signals import State
from aff_runtime.config.loader import load_site
from aff_runtime.fieldbus.modbus.registers import WordType
from aff_runtime.loop.messages import Arm, SupervisorLost
from tests.lockstep.bench import PLC_MAP, SITE, Bench, Setup
from tests.lockstep.fault_table import (
    LASTS_S,
    TROUBLES,
    WORKING_M_S,
    ZERO_WITHIN_S,
    Trouble,
    assert_never_above_limit,
    peak,
    zero_after_s,
)
from tests.lockstep.works_again import assert_works_again

LEARNING_S = 3.0
QUIET_S = 0.7


@pytest.fixture(scope="module")
def working(responses) -> Bench:
    return _at_work(Setup(responses=responses))


@pytest.fixture
def bench(working: Bench) -> Bench:
    """A bench at work; every test has its own copy of the one that was armed."""
    return deepcopy(working)


def _at_work(setup: Setup) -> Bench:
    bench = Bench(setup)
    bench.run(0.5)
    assert bench.guard.state is State.FAULT
    bench.arm(LEARNING_S)
    bench.outside.events.clear()
    return bench


def _assert_goes_to_zero_and_comes_back(bench: Bench, trouble: Trouble) -> None:
    trips = bench.plant.plc.trips
    start_s = bench.inject(trouble.at(0.05))
    bench.run(0.05 + LASTS_S)
    during = bench.applied
    assert peak(during, start_s - 0.3, start_s) > WORKING_M_S
    assert trouble.alarm in bench.outside.events
    assert bench.plant.plc.trips - trips == trouble.trips
    assert peak(during, start_s + ZERO_WITHIN_S, start_s + LASTS_S) == 0.0
    if trouble.latched:
        bench.run(QUIET_S)
        assert bench.guard.state is State.FAULT
        assert peak(bench.applied, start_s + ZERO_WITHIN_S, bench.now_s) == 0.0
        bench.say(Arm())
    assert_works_again(bench, LEARNING_S)
    assert_never_above_limit(bench.applied)
    assert bench.plant.registers.foreign_writes == 0


@pytest.mark.parametrize("name", TROUBLES)
@pytest.mark.sweep(every=2)
def test_fault_takes_the_correction_to_zero_and_only_an_edge_brings_it_back(bench, name):
    _assert_goes_to_zero_and_comes_back(bench, TROUBLES[name])


def test_nan_in_a_float_register_takes_the_correction_to_zero(responses, tmp_path: Path):
    text = PLC_MAP.read_text()
    plc_map = tmp_path / "map.yaml"
    plc_map.write_text(text.replace("type: i32, scale: 0.001 ", "type: f32, scale: 1.0 "))
    words = register_map(load_site(SITE))
    floats = tuple(
        replace(c, type=WordType.F32, scale=1.0) if c.name.endswith("_tension_N") else c
        for c in words.channels
    )
    setup = Setup(responses=responses, plc_map=plc_map, words=replace(words, channels=floats))
    _assert_goes_to_zero_and_comes_back(_at_work(setup), TROUBLES["NaN tension"])


def _one_refused_request(bench: Bench) -> None:
    bench.inject("busy@0.05:0.01")


def _one_dropped_connection(bench: Bench) -> None:
    bench.inject("drop@0.05:0.005")


@pytest.mark.parametrize("hiccup", [_one_refused_request, _one_dropped_connection])
def test_a_hiccup_shorter_than_the_patience_changes_nothing(
    bench: Bench, hiccup: Callable[[Bench], None]
):
    hiccup(bench)
    bench.run(1.0)
    assert bench.guard.state is State.ACTIVE
    assert peak(bench.applied, bench.now_s - 0.3, bench.now_s) > WORKING_M_S


def test_a_killed_runtime_leaves_zero_at_the_plant(bench: Bench):
    killed_s = bench.now_s
    assert peak(bench.applied, killed_s - 0.3, killed_s) > WORKING_M_S
    bench.run_plant_alone(2.0)
    assert 0.1 < zero_after_s(bench.applied, killed_s) < ZERO_WITHIN_S
    assert bench.plant.plc.trips == 1
    assert_never_above_limit(bench.applied)


def test_a_lost_supervisor_makes_the_runtime_fade_and_end(bench: Bench):
    lost_s = bench.now_s
    bench.say(SupervisorLost())
    bench.run(1.0)
    assert "SUPERVISOR_LOST" in bench.outside.events
    assert not bench.cycle.tick()
    bench.run_plant_alone(1.0)
    assert 0.1 < zero_after_s(bench.applied, lost_s) < ZERO_WITHIN_S


def test_stuck_and_mute_at_once_is_still_zero_in_time(bench: Bench):
    bench.inject("stuck@0.05:0.8")
    start_s = bench.inject("mute@0.05:0.8")
    bench.run(2.0)
    assert zero_after_s(bench.applied, start_s) < ZERO_WITHIN_S


def test_a_fault_that_stays_refuses_the_operators_edge(bench: Bench):
    start_s = bench.inject("freeze@0.05")
    bench.run(1.0)
    bench.outside.inbox.clear()
    for _ in range(3):
        bench.say(Arm())
        bench.run(0.5)
        assert bench.guard.state is State.FAULT
    assert peak(bench.applied, start_s + ZERO_WITHIN_S, bench.now_s) == 0.0
    bench.plant.faults.clear()
    bench.run(0.5)
    assert bench.guard.state is State.FAULT  # the edges pressed during the fault are spent
    bench.say(Arm())
    assert_works_again(bench, LEARNING_S)


@pytest.mark.parametrize("spec", ["absurd", "swap"])
@pytest.mark.sweep(every=2)
def test_what_cannot_be_true_is_never_learned_from(bench: Bench, spec: str):
    before = [now for _, now in bench.law.ripple()]
    bench.inject(f"{spec}@0.05:{LASTS_S}")
    bench.run(0.05 + LASTS_S + QUIET_S)
    bench.arm(LEARNING_S)
    for (reference_N, now_N), before_N in zip(bench.law.ripple(), before, strict=True):
        assert now_N < before_N + 3.0  # the ripple of the bare line is below 3 N
        assert reference_N < 6.0
