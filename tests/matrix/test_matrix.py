from __future__ import annotations

from dataclasses import replace

import pytest

from aff_runtime.base.signals import State
from tests.matrix.bench import SAMPLE_S, MatrixBench
from tests.matrix.cells import ZERO_S, Cell, cells, judge
from tests.sim_plant.servers.fake_line import default_map


# the other states: make matrix
@pytest.mark.parametrize("cell", list(cells(("OFF", "ACTIVE"))), ids=str)
def test_every_cell_reacts_as_the_table_says(cell: Cell) -> None:
    assert judge(cell) == ""


@pytest.mark.parametrize("other_armed", [False, True])
def test_two_runtimes_on_one_plc_leave_no_correction(other_armed: bool) -> None:
    ours = MatrixBench("modbus")
    ours.run(0.5)
    ours.arm()
    assert ours.until(State.ACTIVE)
    ours.run(0.5)
    assert any(ours.applied[-20:])
    other = MatrixBench("modbus")
    other.lockstep, other.plant, other.clock = ours.lockstep, ours.plant, ours.clock
    other.start()

    def both(seconds: float) -> list[float]:
        applied = []
        for k in range(round(seconds / SAMPLE_S)):
            first, second = (ours, other) if k % 3 else (other, ours)  # who comes last varies
            applied.append(first.step())
            second.cycle.tick()
        return applied

    both(ZERO_S)
    assert not any(both(0.5))
    if other_armed:
        other.arm()
        both(ZERO_S)  # until both say ACTIVE
        assert not any(both(1.0))
    ours.bypass()
    ours.run(0.4)
    ours.arm()
    ours.run(1.0)
    assert any(ours.applied[-20:])  # alone again, after an operator's edge


def test_a_drive_notices_by_itself_that_the_runtime_is_gone() -> None:
    bench = MatrixBench("canopen")
    bench.run(1.0)
    bench.arm()
    assert bench.until(State.ACTIVE)
    assert bench.bus is not None
    drives = bench.bus._node._devices.values()  # type: ignore[attr-defined]
    assert {drive.emcy for drive in drives} == {0}
    bench.begin("!kill")
    bench.run(ZERO_S)
    assert {drive.emcy for drive in drives} & {0x8130, 0x8250}  # heartbeat, RPDO timeout


@pytest.mark.parametrize("wire", ["can", "canopen"])
@pytest.mark.parametrize(
    ("sample_s", "through_ms"),
    [
        (0.020, (40,)),  # what a soak of 24 hours met: zero 340 ms after the loss began
        (0.020, (60, 140)),
        (0.010, (40, 80, 120)),
        (0.005, (40, 80, 120, 160)),
    ],
)
def test_commands_that_pass_a_bus_that_loses_the_rest_do_not_make_zero_late(
    wire: str, sample_s: float, through_ms: tuple[int, ...]
) -> None:
    bench = MatrixBench(wire, sample_s=sample_s)
    bench.run(4.0)  # nodes are configured by one request a tick
    bench.arm()
    assert bench.until(State.ACTIVE)
    bench.run(0.5)
    assert bench.bus is not None
    passes = False
    bench.bus._faults._lost = lambda: not passes  # type: ignore[method-assign]
    bench.begin("lose=100")
    writes = bench.plant.registers.writes
    seen = []
    for sample in range(round(0.6 / sample_s)):
        passes = round(1e3 * sample_s * sample) in through_ms
        seen += bench.run(sample_s)
    obeyed = bench.plant.registers.writes - writes
    assert obeyed == len(through_ms) if wire == "can" else obeyed > 0  # nodes stop by themselves
    assert any(seen[: round(0.1 / sample_s)])
    assert not any(seen[round(ZERO_S / sample_s) :])


def test_a_refusal_that_only_the_plc_sees_reaches_the_runtime() -> None:
    bench = MatrixBench("modbus")
    bench.run(0.5)
    bench.arm()
    assert bench.until(State.ACTIVE)
    bench.run(0.5)
    bench.plant.plc.map = replace(bench.plant.plc.map, corrections=tuple(
        replace(row, limit_m_s=0.01) for row in bench.plant.plc.map.corrections
    ))  # fmt: skip
    bench.run(ZERO_S)
    assert "AFF_ENABLE_REQUEST=0" in bench.guard.first_blocking()
    assert not any(bench.run(1.0))
    bench.plant.plc.map = default_map()
    assert not any(bench.run(1.0))  # an operator's edge is needed
    bench.bypass()
    bench.run(0.1)
    bench.arm()
    bench.run(1.0)
    assert any(bench.applied[-20:])


@pytest.mark.parametrize("spec", ["mute:0.05", "!stall:0.05", "lose=10:1"])
@pytest.mark.parametrize("sample_s", [0.005, 0.010])
@pytest.mark.parametrize("wire", ["modbus", "can", "canopen"])
def test_a_pause_of_50_ms_and_a_tenth_of_the_frames_trip_nobody(
    wire: str, sample_s: float, spec: str
) -> None:
    if wire == "modbus" and spec.startswith("lose"):
        pytest.skip("TCP sends again what was lost")
    bench = MatrixBench(wire, sample_s=sample_s)
    bench.run(4.0)
    bench.arm()
    assert bench.until(State.ACTIVE)
    bench.run(0.5)
    trips = bench.plant.plc.trips
    bench.begin(spec)
    bench.run(float(spec.partition(":")[2]))
    bench.running = True
    bench.run(0.5)
    assert bench.plant.plc.trips == trips
    assert bench.guard.state is State.ACTIVE
    assert bench.plant.refusal == ""
