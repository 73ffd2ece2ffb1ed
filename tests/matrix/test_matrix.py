from __future__ import annotations

import pytest

from aff_runtime.base.signals import State
from tests.matrix.bench import SAMPLE_S, MatrixBench
from tests.matrix.cells import ZERO_S, Cell, cells, judge


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
