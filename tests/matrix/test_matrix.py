from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import pytest

from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import State
from tests.matrix.bench import SAMPLE_S, MatrixBench
from tests.matrix.cells import ZERO_S, Cell, cells, judge
from tests.sim_plant.servers.fake_line import default_map

pytestmark = pytest.mark.processes


def covering() -> Iterator[Cell]:
    """Yield each fault on each wire once, in ACTIVE and OFF by turns from wire to wire.

    A fault of one wire alone comes in both. The other cells: ``make matrix``.
    """
    at_rest, at_work = (list(cells((state,))) for state in ("OFF", "ACTIVE"))
    wires = Counter(cell.fault for cell in at_work)
    for number, pair in enumerate(zip(at_work, at_rest, strict=True)):
        yield from pair if wires[pair[0].fault] == 1 else (pair[number % 2],)


def quick() -> list[object]:
    """Return the covering cells; of each fault one is quick, Modbus and CAN by turns.

    A cell of CANopen takes four times as long as one of Modbus: quick are its own faults alone.
    """
    every = list(covering())
    chosen = []
    for turn, fault in enumerate(dict.fromkeys(cell.fault for cell in every)):
        of = [cell for cell in every if cell.fault == fault]
        cheap = [cell for cell in of if cell.wire != "canopen"] or of
        chosen.append(cheap[turn % len(cheap)])
    return [
        pytest.param(cell, marks=() if cell in chosen else pytest.mark.long, id=str(cell))
        for cell in every
    ]


def test_the_covering_cells_have_every_fault_on_every_wire_and_in_both_states() -> None:
    chosen, every = list(covering()), list(cells())
    assert {(c.fault, c.wire, c.reaction) for c in chosen} == {
        (c.fault, c.wire, c.reaction) for c in every
    }
    both = {(c.fault, state) for c in every for state in ("OFF", "ACTIVE")}
    assert {(c.fault, c.state) for c in chosen} == both


@pytest.mark.parametrize("cell", quick())
def test_every_cell_reacts_as_the_table_says(cell: Cell) -> None:
    assert judge(cell) == ""


@dataclass
class Two:
    """Two runtimes on one Modbus PLC; ours comes first or last as ``order`` of the scan says."""

    order: Callable[[int], bool]
    echo: bool = True
    scans: int = 0

    def __post_init__(self) -> None:
        self.ours = ours = MatrixBench("modbus", echo=self.echo)
        ours.run(0.5)
        ours.arm()
        assert ours.until(State.ACTIVE)
        ours.run(0.5)
        assert any(ours.applied[-20:])
        self.other = other = MatrixBench("modbus", echo=self.echo)
        other.lockstep, other.plant, other.clock = ours.lockstep, ours.plant, ours.clock
        other.start()

    def run(self, seconds: float) -> list[float]:
        """Return the largest correction at the plant per scan."""
        applied = []
        for _ in range(round(seconds / SAMPLE_S)):
            self.scans += 1
            ours_first = self.order(self.scans)
            if not ours_first:
                self.other.cycle.tick()
            applied.append(self.ours.step())
            if ours_first:
                self.other.cycle.tick()
        return applied

    def blocked(self) -> list[bool]:
        """Return of both whether they rest in FAULT and say that another is there."""
        guards = (self.ours.guard, self.other.guard)
        said = [g.first_blocking() == "blocked by SECOND_MASTER" for g in guards]
        return [s and g.state is State.FAULT for s, g in zip(said, guards, strict=True)]


def ours_mostly_first(scan: int) -> bool:
    return scan % 3 > 0


@pytest.mark.parametrize("echo", [False, True])
@pytest.mark.parametrize("other_armed", [False, True])
def test_two_runtimes_on_one_plc_leave_no_correction(other_armed: bool, echo: bool) -> None:
    two = Two(ours_mostly_first, echo)
    two.run(ZERO_S)
    assert not any(two.run(0.5))
    assert two.blocked() == [echo, echo]
    if other_armed:
        two.other.arm()
        two.run(ZERO_S)  # until both say ACTIVE, where no echo keeps them from it
        assert not any(two.run(1.0))
    ours = two.ours
    ours.bypass()
    ours.run(0.6)
    ours.arm()
    ours.run(1.0)
    assert any(ours.applied[-20:])  # alone again, after an operator's edge


@pytest.mark.parametrize("armed", [False, True])
def test_a_runtime_that_never_writes_last_learns_that_nothing_of_it_is_applied(
    armed: bool,
) -> None:
    two = Two(lambda _: True)
    two.run(0.05)
    if armed:
        two.other.arm()
    seen = two.run(ZERO_S)
    assert two.blocked() == [True, False]
    assert not any(seen[-5:]) or armed
    two.ours.arm()
    two.run(1.0)
    assert two.blocked() == [True, False]
    assert (two.other.guard.state is State.ACTIVE) == armed
    two.ours.run(0.6)  # alone again: nothing comes back by itself
    assert not any(two.ours.run(0.1))
    two.ours.arm()
    two.ours.run(1.0)
    assert any(two.ours.applied[-20:])


def test_without_an_echo_it_does_not_learn_it() -> None:
    """What ``aff-runtime check`` warns of, and why the word is there."""
    two = Two(lambda _: True, echo=False)
    two.run(1.0)
    assert two.ours.guard.state is State.ACTIVE
    assert two.ours.plant.refusal.startswith("state")


@pytest.mark.parametrize("wire", ["modbus", "can", "canopen"])
@pytest.mark.sweep(every=3)
def test_a_plc_that_says_nothing_of_us_cannot_be_armed_and_is_no_alarm(wire: str) -> None:
    bench = MatrixBench(wire)
    bench.begin("last:2")
    bench.run(1.5)
    bench.arm()
    bench.run(0.2)
    assert bench.guard.state is State.FAULT
    assert bench.guard.first_blocking() == "blocked by SECOND_MASTER"
    assert BY_NAME["SECOND_MASTER"].code not in bench.around.codes
    bench.run(1.0)
    bench.arm()
    assert bench.until(State.ACTIVE)
    bench.begin("last:0.2")
    bench.run(0.2)
    assert bench.around.codes.count(BY_NAME["SECOND_MASTER"].code) == 1


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
@pytest.mark.sweep(every=5)
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
    bench.plant.plc.map = replace(
        bench.plant.plc.map,
        corrections=tuple(replace(row, limit_m_s=0.01) for row in bench.plant.plc.map.corrections),
    )
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
@pytest.mark.sweep(every=11)
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
