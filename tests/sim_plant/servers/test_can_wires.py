"""Plant and gateway over transports that reach another process: unix frames and a serial line."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.python_can import can
from aff_runtime.base.signals import Outcome, Snapshot
from aff_runtime.config.can_wire import can_map_of, network_of, wire_files
from aff_runtime.config.loader import load_site
from aff_runtime.fieldbus.can.frame_socket import FrameSocketBus
from aff_runtime.fieldbus.can.gateway import CanGateway
from aff_runtime.fieldbus.can_catalogue import BusSite, can_gateway, canopen_gateway
from sim_plant.servers.answers import to_json
from sim_plant.servers.control import ControlSocket
from sim_plant.servers.serve import PlantService, ServeOptions
from tests.aff_runtime.fieldbus.euclid_can import command
from tests.sim_plant.servers.fake_line import FakeLine, default_map

pytestmark = pytest.mark.wire
CONFIG = Path(__file__).parents[3] / "config"
SITE_FILE = {"dbc": "euclid_can.yaml", "canopen": "euclid_canopen.yaml"}
OURS = {"frame_socket": "frame_socket", "slcan_pty": "slcan_tty"}
PATIENCE_s = 20.0


class Bench:
    def __init__(self, protocol: str, interface: str, channel: Path) -> None:
        self.clock = MonotonicClock()
        self.ticks = 0
        bus = BusSite(interface=OURS[interface], channel=str(channel), bitrate=500_000)
        self.gateway = gateway_of(protocol, bus, self.clock)
        ready = threading.Event()

        async def serve() -> None:
            options = ServeOptions(
                can=protocol,
                can_interface=interface,
                can_channel=str(channel),
                realtime=False,
                can_map=CONFIG / "plc" / f"can_{protocol}.yaml",
            )
            self.service = PlantService(FakeLine(0.01), default_map(), options)
            self.loop = asyncio.get_running_loop()
            await self.service.run(lambda _: ready.set())

        self.thread = threading.Thread(target=asyncio.run, args=(serve(),))
        self.thread.start()
        assert ready.wait(PATIENCE_s)

    def tick(self) -> Snapshot:
        self.ticks += 1
        now_ns = self.clock.now_ns()
        shot = self.gateway.exchange(
            command(self.ticks, (0.001, 0.0)), self.ticks, now_ns + 30_000_000
        )
        time.sleep(0.003)
        return shot

    def until(self, wanted: Callable[[Snapshot], bool]) -> Snapshot:
        give_up = time.monotonic() + PATIENCE_s
        while time.monotonic() < give_up:
            shot = self.tick()
            if wanted(shot):
                return shot
        raise AssertionError(f"never; last {shot}")

    def fault(self, spec: str) -> None:
        control = ControlSocket(Path(), self.service.plant, self.service.status)

        async def inject() -> dict[str, object]:
            return to_json(await control.answer(f"fault {spec}"))

        done = asyncio.run_coroutine_threadsafe(inject(), self.loop)
        assert done.result(PATIENCE_s)["ok"]

    def close(self) -> None:
        self.gateway.close()
        self.loop.call_soon_threadsafe(self.service.stop)
        self.thread.join(PATIENCE_s)
        assert not self.thread.is_alive()


def gateway_of(protocol: str, bus: BusSite, clock: MonotonicClock) -> CanGateway:
    site = load_site(CONFIG / SITE_FILE[protocol])
    texts = wire_files(site, CONFIG)
    if protocol == "dbc":
        return can_gateway(can_map_of(site, texts), bus, clock)
    return canopen_gateway(network_of(site, texts), bus, clock, own_node=100, heartbeat_ms=20)


@pytest.fixture(
    params=[("dbc", "frame_socket"), ("dbc", "slcan_pty"), ("canopen", "frame_socket")],
    ids="-".join,
)
def bench(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Bench]:
    running = Bench(*request.param, tmp_path / "can")
    yield running
    running.close()


def is_fresh(shot: Snapshot) -> bool:
    return shot.fresh


def test_readings_come_and_commands_arrive(bench: Bench) -> None:
    shot = bench.until(is_fresh)
    assert shot.values[1:6] == pytest.approx((90.0, 1.0, 0.15, 1.0, 95.0), abs=1e-3)
    plc_map = bench.service.plant.plc.map
    at = plc_map.corrections[0].item.address - plc_map.write_start
    bench.until(lambda _: bench.service.plant.registers.write_words[at] == 100)


@pytest.mark.parametrize("fault", ["busoff:0.3", "drop:0.3", "restart:0.3"])
@pytest.mark.sweep(every=4)
def test_a_lost_bus_is_not_connected_and_comes_back_by_itself(bench: Bench, fault: str) -> None:
    bench.until(is_fresh)
    bench.fault(fault)
    bench.until(lambda shot: shot.outcome is Outcome.NOT_CONNECTED)
    bench.until(is_fresh)


def test_a_frozen_plc_is_never_fresh(bench: Bench) -> None:
    bench.until(is_fresh)
    bench.fault("freeze:0.5")
    bench.until(lambda shot: shot.age_s > 0.2)
    bench.until(is_fresh)


def test_a_second_master_on_the_bus_is_seen(tmp_path: Path) -> None:
    bench = Bench("dbc", "frame_socket", tmp_path / "can")
    try:
        bench.until(is_fresh)
        with FrameSocketBus(str(tmp_path / "can")) as other:
            other.send(can.Message(arbitration_id=0x200, is_extended_id=False, data=bytes(8)))
            bench.until(lambda shot: shot.outcome is Outcome.BAD_REPLY)
        assert bench.gateway.foreign == 1
    finally:
        bench.close()


def test_the_unix_bus_stamps_what_arrives(tmp_path: Path) -> None:
    bench = Bench("dbc", "frame_socket", tmp_path / "can")
    try:
        bench.until(lambda shot: shot.fresh and bench.gateway._stamped)
    finally:
        bench.close()
