"""Against pyModbusTCP, a second Modbus library without a line of pymodbus, on both sides."""

from __future__ import annotations

import asyncio
import contextlib
import threading
from collections.abc import Iterator

import pytest
from pyModbusTCP.client import ModbusClient
from pyModbusTCP.server import DataBank, ModbusServer

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.signals import Outcome
from aff_runtime.fieldbus.modbus.codec import WordCodec
from aff_runtime.fieldbus.modbus.connections import modbus, tcp_wire
from aff_runtime.fieldbus.modbus.frames import WireFunction
from aff_runtime.fieldbus.modbus.gateway import WordGateway
from sim_plant.servers.serve import PlantService, ServeOptions
from tests.aff_runtime.fieldbus.euclid_map import command, euclid_map
from tests.sim_plant.servers.fake_line import FakeLine, default_map, write_block

pytestmark = pytest.mark.wire


class Bank(DataBank):
    """Holding registers whose heartbeat moves whenever they are read."""

    def get_holding_registers(
        self, address: int, number: int = 1, srv_info: object = None
    ) -> list[int] | None:
        beat = super().get_holding_registers(0, 1)[0]
        self.set_holding_registers(0, [(beat + 1) & 0xFFFF])
        found: list[int] | None = super().get_holding_registers(address, number, srv_info)
        return found


@pytest.fixture
def server() -> Iterator[ModbusServer]:
    # port 0 would not tell which one it got; the listener below gives the number back first
    import socket

    with socket.create_server(("127.0.0.1", 0)) as probe:
        port = probe.getsockname()[1]
    bank = Bank(h_regs_size=200)
    running = ModbusServer(host="127.0.0.1", port=port, no_block=True, data_bank=bank)
    running.start()
    yield running
    running.stop()


@pytest.mark.parametrize("function", [WireFunction.FC23, WireFunction.FC3_FC16])
def test_the_runtime_understands_it_and_it_the_runtime(
    server: ModbusServer, function: WireFunction
) -> None:
    clock = MonotonicClock()
    server.data_bank.set_holding_registers(1, [45, 1, 24464, 9000, 1000, 10000, 64520, 12])
    transport = modbus(
        tcp_wire("127.0.0.1", server.port),
        device_id=1,
        register_map=euclid_map(),
        clock=clock,
        function=function,
    )
    gateway = WordGateway(transport, WordCodec(euclid_map()), clock)
    shots = []
    for tick in range(40):
        said = command(heartbeat=tick, corrections=(0.001, -0.001))
        shots.append(gateway.exchange(said, tick, clock.now_ns() + 500_000_000))
        clock.sleep_until_ns(clock.now_ns() + 1_000_000)
    gateway.close()
    good = [shot for shot in shots if shot.outcome is Outcome.OK]
    assert len(good) > 20
    assert all(shot.fresh for shot in good[1:])
    assert good[-1].values[:5] == pytest.approx((90.0, 90.0, 1.0, 0.2, -1.016))
    assert (good[-1].status, good[-1].roll_id) == (45, 12)
    written = server.data_bank.get_holding_registers(100, 10)
    assert written == [39, 0, 0, 100, 65435, 0, 5000, 0, 65436, 99]


def test_a_register_it_does_not_have_is_an_exception(server: ModbusServer) -> None:
    clock = MonotonicClock()
    absent = euclid_map(plc_heartbeat=500, status=501, roll_id=502, channels=())
    transport = modbus(
        tcp_wire("127.0.0.1", server.port), device_id=1, clock=clock, register_map=absent
    )
    seen = set()
    for _ in range(10):
        outcome, words = transport.transact([0] * 10, clock.now_ns() + 500_000_000)
        assert words == []
        seen.add(outcome)
        clock.sleep_until_ns(clock.now_ns() + 1_000_000)
    transport.close()
    assert seen == {Outcome.NOT_CONNECTED, Outcome.EXCEPTION}


@pytest.fixture
def plant() -> Iterator[tuple[PlantService, int]]:
    ready = threading.Event()
    found: dict[str, object] = {}

    async def serve() -> None:
        options = ServeOptions(host="127.0.0.1", port=0, realtime=False)
        service = PlantService(FakeLine(0.01), default_map(), options)
        found["service"], found["loop"] = service, asyncio.get_running_loop()

        def announce(text: str) -> None:
            found["line"] = text
            ready.set()

        await service.run(announce)

    thread = threading.Thread(target=asyncio.run, args=(serve(),))
    thread.start()
    assert ready.wait(20)
    service, loop = found["service"], found["loop"]
    assert isinstance(service, PlantService)
    assert isinstance(loop, asyncio.AbstractEventLoop)
    port = int(str(found["line"]).split()[2].rpartition(":")[2])
    yield service, port
    loop.call_soon_threadsafe(service.stop)
    thread.join(20)


def test_its_client_reads_and_writes_the_simulated_plc(plant: tuple[PlantService, int]) -> None:
    service, port = plant
    client = ModbusClient(host="127.0.0.1", port=port, unit_id=1, timeout=5.0)
    with contextlib.closing(client):
        words = client.read_holding_registers(0, 15)
        assert words is not None
        assert words[4:7] == [9000, 1000, 7500]  # 90 N, 1 m/s, 0.15 m
        block = write_block(7, unwind=100)
        assert client.write_multiple_registers(100, block)
        assert service.plant.registers.write_words == block
        again = client.write_read_multiple_registers(100, write_block(8, unwind=-3), 0, 15)
        assert again is not None
        assert again[4:7] == [9000, 1000, 7500]
        assert service.plant.registers.write_words == write_block(8, unwind=-3)
        assert client.read_holding_registers(5000, 1) is None
        assert client.last_except == 2
