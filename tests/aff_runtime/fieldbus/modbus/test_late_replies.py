"""A reply that comes late costs no connection; a lost connection is replaced in time."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from aff_runtime.base.signals import State
from aff_runtime.fieldbus.modbus.transport import silence_before_reconnect
from tests.aff_runtime.fieldbus.modbus_bench import WIRES, Bench
from tests.each_case import each_case

FAULT_MS = {5: 80, 8: 80, 10: 80, 12: 80, 15: 80, 20: 120}
"""Of each cycle, ms: the shipped one where five cycles fit, so that four ticks late is in time."""
Make = Callable[[str, int, int], Bench]


@pytest.fixture
def make(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Make:
    return lambda wire, cycle_ms, fault_ms: Bench(wire, cycle_ms, fault_ms, tmp_path, monkeypatch)


def late_twice(bench: Bench, pause_ms: int) -> None:
    """Two replies so late, 1 s apart; no answer to an earlier question counts as a reading."""
    for _ in range(2):
        bench.pause_ms = pause_ms
        for _ in range(1000 // bench.cycle_ms):
            before = bench.plc.heartbeat, bench.runtime.now("plc_heartbeat")
            bench.runtime.run(1)
            heard = bench.runtime.now("plc_heartbeat")
            assert heard in (before[1], bench.plc.heartbeat)
        assert bench.runtime.guard.state is State.ACTIVE, bench.runtime.outside.reasons
    assert bench.drops == 0
    assert bench.runtime.is_working


@pytest.mark.sweep(every=29)  # beside the pauses below
@pytest.mark.parametrize("drops_while_busy", [False, True])
@pytest.mark.parametrize("late_ticks", [1, 2, 3, 4])
@pytest.mark.parametrize(
    ("wire", "cycle_ms"),
    [(wire, ms) for wire in WIRES for ms in FAULT_MS if (wire, ms) != ("modbus_rtu", 5)],
)  # the frames of the site's block take more than the deadline of that cycle on a line
def test_two_late_replies_a_second_apart_cost_no_connection(
    make: Make, wire: str, cycle_ms: int, late_ticks: int, drops_while_busy: bool
) -> None:
    bench = make(wire, cycle_ms, FAULT_MS[cycle_ms])
    bench.drops_while_busy = drops_while_busy
    late_twice(bench, late_ticks * cycle_ms - 1)


@pytest.mark.parametrize(
    ("cycle_ms", "fault_ms", "pause_ms"),
    [(10, 80, 33), (10, 80, 45), (12, 80, 25), (15, 80, 17), (20, 120, 22), (20, 80, 39)],
)
@pytest.mark.parametrize("wire", WIRES)
@pytest.mark.sweep(every=5)
def test_a_pause_of_the_plc_between_two_ticks_is_waited_for(
    make: Make, wire: str, cycle_ms: int, fault_ms: int, pause_ms: int
) -> None:
    late_twice(make(wire, cycle_ms, fault_ms), pause_ms)


@pytest.mark.parametrize(
    ("cycle_ms", "fault_ms"), [(4, 80), (5, 80), (7, 80), (10, 120), (12, 80), (20, 80)]
)
@pytest.mark.parametrize("wire", ["modbus_tcp", "modbus_rtu_tcp"])
@pytest.mark.sweep(every=5)
def test_a_connection_that_is_lost_is_replaced_in_time_where_11_cycles_fit(
    make: Make, wire: str, cycle_ms: int, fault_ms: int
) -> None:
    bench = make(wire, cycle_ms, fault_ms)
    in_time = 11 * cycle_ms <= fault_ms
    for number in (1, 2):  # the second one is half a second old
        bench.cut()
        bench.runtime.run(500 // cycle_ms)
        assert bench.runtime.guard.state is (State.ACTIVE if in_time else State.FAULT)
        assert bench.drops == number


@each_case("fault_ms", [80, 120, 180, 290])
def test_the_silence_grows_with_the_cycle_and_leaves_time_for_a_new_connection(
    fault_ms: int,
) -> None:
    cycles_ms = range(1, fault_ms // 3 + 1)
    silences = [1e3 * silence_before_reconnect(c * 1e-3, fault_ms * 1e-3) for c in cycles_ms]
    assert silences == sorted(silences)
    for cycle_ms, silence_ms in zip(cycles_ms, silences, strict=True):
        assert silence_ms >= 2 * cycle_ms + 0.4 * cycle_ms
        dropped = next(
            j for j in range(1, 1000) if j * cycle_ms >= silence_ms
        )  # ticks after asking
        if 11 * cycle_ms <= fault_ms:
            # the tick before the fresh one: the request, the drop, an attempt, heard once
            assert (dropped + 3) * cycle_ms < fault_ms  # since the heartbeat last moved


def test_the_shipped_times_keep_their_silence() -> None:
    assert silence_before_reconnect(0.005, 0.080) == pytest.approx(0.050)
