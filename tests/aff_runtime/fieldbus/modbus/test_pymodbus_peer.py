"""Against pymodbus' own server, which shares no line with our transport but the frame layout."""

from __future__ import annotations

import time
from functools import partial

import pytest
from pymodbus.server import ModbusTcpServer

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.signals import Outcome
from aff_runtime.fieldbus.modbus.codec import WordCodec
from aff_runtime.fieldbus.modbus.connections import modbus, tcp_wire
from aff_runtime.fieldbus.modbus.frames import WireFunction
from aff_runtime.fieldbus.modbus.gateway import WordGateway
from aff_runtime.fieldbus.modbus.probe_map import open_read_only, probe_map
from aff_runtime.fieldbus.modbus.tcp_wire import TcpWire
from tests.aff_runtime.fieldbus.euclid_map import command, euclid_map
from tests.aff_runtime.fieldbus.modbus.strange_server import StrangeServer

pytestmark = pytest.mark.wire


class Peer(StrangeServer):
    """Holding registers over TCP, whatever was written stays."""

    def __init__(self) -> None:
        super().__init__(partial(ModbusTcpServer, address=("127.0.0.1", 0)), [0] * 200)
        self.registers = [0] * 200
        self.writes: list[tuple[int, list[int]]] = []

    async def act(
        self,
        function: int,
        start: int,
        address: int,
        count: int,
        current: list[int],
        written: list[int] | list[bool] | None,
    ) -> None:
        if written is not None:
            self.writes.append((address, [int(word) for word in written]))
        else:
            current[address - start : address - start + 99] = self.registers[:99]
            self.registers[0] = (self.registers[0] + 1) & 0xFFFF


@pytest.mark.parametrize("function", [WireFunction.FC23, WireFunction.FC3_FC16])
def test_a_strange_server_understands_us_and_we_it(function: WireFunction) -> None:
    clock = MonotonicClock()
    with Peer() as peer:
        peer.registers[1:9] = [45, 1, 24464, 9000, 1000, 10000, 64520, 12]
        transport = modbus(
            tcp_wire("localhost", peer.port),
            device_id=1,
            register_map=euclid_map(),
            clock=clock,
            function=function,
        )
        gateway = WordGateway(transport, WordCodec(euclid_map()), clock)
        snapshots = []
        for tick in range(60):
            said = command(heartbeat=tick, corrections=(0.001, -0.001))
            snapshots.append(gateway.exchange(said, tick, clock.now_ns() + 2_000_000_000))
            time.sleep(0.001)
        gateway.close()
    first_good = [snapshot.outcome for snapshot in snapshots].index(Outcome.OK)
    good = snapshots[first_good:]
    assert {snapshot.outcome for snapshot in good} == {Outcome.OK}
    assert all(snapshot.fresh for snapshot in good)
    assert good[-1].values[:5] == pytest.approx((90.0, 90.0, 1.0, 0.2, -1.016))
    assert (good[-1].status, good[-1].roll_id) == (45, 12)
    address, words = peer.writes[-1]
    assert (address, words) == (100, [59, 0, 0, 100, 65435, 0, 5000, 0, 65436, 99])
    assert {address for address, _ in peer.writes} == {100}


def test_an_unknown_device_is_an_exception_not_a_number() -> None:
    clock = MonotonicClock()
    with Peer() as peer:
        transport = modbus(
            tcp_wire("127.0.0.1", peer.port),
            device_id=1,
            clock=clock,
            register_map=euclid_map(status=500, plc_heartbeat=501, roll_id=502, channels=()),
        )
        outcomes = set()
        for _ in range(20):
            outcome, words = transport.transact([0] * 10, clock.now_ns() + 2_000_000_000)
            outcomes.add(outcome)
            assert words == []
            time.sleep(0.001)
        transport.close()
    assert outcomes == {Outcome.NOT_CONNECTED, Outcome.EXCEPTION}


def test_the_probe_reads_and_writes_nothing() -> None:
    clock = MonotonicClock()
    with Peer() as peer:
        peer.registers[2:4] = [0x3F80, 0x0000]
        transport = open_read_only(
            wire=TcpWire("127.0.0.1", peer.port),
            device_id=1,
            read_start=0,
            read_count=8,
            clock=clock,
        )
        seen = probe_map(
            transport, clock, read_start=0, heartbeat_address=0, attempts=12, period_s=0.05
        )
        transport.close()
    assert peer.writes == []
    assert seen.heartbeat_moves
    assert [word.address for word in seen.words if word.changes] == [0]
    assert seen.words[2].decodings[0].f32 == 1.0
