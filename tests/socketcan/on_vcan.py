"""The runtime's gateway and the plant on one genuine SocketCAN bus; run by the guest."""

from __future__ import annotations

import asyncio
import fcntl
import socket
import struct
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.python_can import can
from aff_runtime.base.signals import Outcome, Snapshot
from aff_runtime.config.can_wire import can_map_of, network_of, wire_files
from aff_runtime.config.loader import load_site
from aff_runtime.fieldbus.can.gateway import CanGateway
from aff_runtime.fieldbus.can_catalogue import BusSite, can_gateway, canopen_gateway, open_bus
from sim_plant.servers.serve import PlantService, ServeOptions
from tests.aff_runtime.fieldbus.euclid_can import command
from tests.sim_plant.servers.fake_line import FakeLine, default_map

CONFIG = Path(__file__).parents[2] / "config"
BUS = BusSite(interface="socketcan", channel="vcan0", bitrate=500_000)
PERIOD_S = 0.05  # an emulated processor is slow
SIOCGIFFLAGS, SIOCSIFFLAGS, IFF_UP = 0x8913, 0x8914, 1


def set_link(up: bool) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        request = struct.pack("16sh14x", b"vcan0", 0)
        flags = struct.unpack_from("h", fcntl.ioctl(sock, SIOCGIFFLAGS, request), 16)[0]
        flags = flags | IFF_UP if up else flags & ~IFF_UP
        fcntl.ioctl(sock, SIOCSIFFLAGS, struct.pack("16sh14x", b"vcan0", flags))


@pytest.fixture(params=["dbc", "canopen"])
def bench(request: pytest.FixtureRequest) -> Iterator[Bench]:
    set_link(True)
    running = Bench(request.param)
    yield running
    running.close()
    set_link(True)


class Bench:
    """The plant in a thread of its own, the gateway in ours."""

    def __init__(self, protocol: str) -> None:
        self.clock = MonotonicClock()
        self.ticks = 0
        self.gateway = gateway_of(protocol, self.clock)
        ready = threading.Event()

        async def serve() -> None:
            options = ServeOptions(
                can=protocol,
                can_interface="socketcan",
                can_channel="vcan0",
                realtime=False,
                can_map=CONFIG / "plc" / f"can_{protocol}.yaml",
            )
            self.service = PlantService(FakeLine(PERIOD_S), default_map(), options)
            self.loop = asyncio.get_running_loop()
            await self.service.run(lambda _: ready.set())

        self.thread = threading.Thread(target=asyncio.run, args=(serve(),))
        self.thread.start()
        assert ready.wait(60)

    def tick(self) -> Snapshot:
        self.ticks += 1
        now_ns = self.clock.now_ns()
        shot = self.gateway.exchange(
            command(self.ticks, (0.001, 0.0)), self.ticks, now_ns + 200_000_000
        )
        self.clock.sleep_until_ns(now_ns + 20_000_000)
        return shot

    def until(self, wanted: Callable[[Snapshot], bool], ticks: int = 1500) -> Snapshot:
        for _ in range(ticks):
            shot = self.tick()
            if wanted(shot):
                return shot
        raise AssertionError(f"never; last {shot}")

    def close(self) -> None:
        self.gateway.close()
        self.loop.call_soon_threadsafe(self.service.stop)
        self.thread.join(30)


def gateway_of(protocol: str, clock: MonotonicClock) -> CanGateway:
    name = {"dbc": "euclid_can.yaml", "canopen": "euclid_canopen.yaml"}[protocol]
    site = load_site(CONFIG / name)
    texts = wire_files(site, CONFIG)
    if protocol == "dbc":
        return can_gateway(can_map_of(site, texts), BUS, clock)
    return canopen_gateway(network_of(site, texts), BUS, clock, own_node=100, heartbeat_ms=20)


def test_readings_come_and_commands_arrive(bench: Bench) -> None:
    shot = bench.until(lambda s: s.fresh)
    assert shot.values[1:6] == pytest.approx((90.0, 1.0, 0.15, 1.0, 95.0), abs=1e-3)
    plc_map = bench.service.plant.plc.map
    at = plc_map.corrections[0].item.address - plc_map.write_start
    bench.until(lambda _: bench.service.plant.registers.write_words[at] == 100)


def test_the_kernel_s_receive_stamp_is_the_age_of_a_set(bench: Bench) -> None:
    bench.until(lambda s: s.fresh)
    bench.until(lambda s: s.fresh and bench.gateway._stamped)


def test_a_bus_that_goes_down_is_not_connected_and_comes_back(bench: Bench) -> None:
    bench.until(lambda s: s.fresh)
    set_link(False)
    bench.until(lambda s: s.outcome is Outcome.NOT_CONNECTED)
    set_link(True)
    bench.until(lambda s: s.fresh)


def test_a_second_master_is_seen(bench: Bench) -> None:
    bench.until(lambda s: s.fresh)
    with can.Bus(interface="socketcan", channel="vcan0") as other:
        ours = sorted(bench.gateway._ours)[0][0]
        other.send(can.Message(arbitration_id=ours, is_extended_id=False, data=bytes(8)))
        bench.until(lambda s: s.outcome is Outcome.BAD_REPLY)
    assert bench.gateway.foreign == 1


@pytest.mark.parametrize("bench", ["canopen"], indirect=True)
@pytest.mark.parametrize(
    ("can_id", "data", "word"),
    [(0x764, b"\x05", "the heartbeat of node 100"), (0x080, b"", "SYNC")],
)
def test_a_second_sync_or_a_device_with_our_node_id_is_heard_through_the_kernel_s_filters(
    bench: Bench, can_id: int, data: bytes, word: str
) -> None:
    bench.until(lambda s: s.fresh)
    with can.Bus(interface="socketcan", channel="vcan0") as other:
        other.send(can.Message(arbitration_id=can_id, is_extended_id=False, data=data))
        bench.until(lambda s: s.outcome is Outcome.NOT_CONNECTED)
    assert word in bench.gateway.troubles[0]
    bench.until(lambda s: s.fresh)  # a second after it was last heard


def test_foreign_traffic_stays_in_the_kernel(bench: Bench) -> None:
    ours = bench.gateway.reader.ids[0]
    with (
        open_bus(BUS.interface, BUS.channel, BUS.bitrate, (ours,)) as heard,
        can.Bus(interface="socketcan", channel="vcan0") as other,
    ):
        for can_id in (0x7F0, ours[0]) * 5:
            other.send(can.Message(arbitration_id=can_id, is_extended_id=False, data=bytes(8)))
        frames = [heard.recv(5.0) for _ in range(5)]  # the plant's own may be among them
    assert {f.arbitration_id for f in frames if f is not None} == {ours[0]}


def test_a_burst_of_foreign_traffic_is_survived(bench: Bench) -> None:
    bench.until(lambda s: s.fresh)
    with can.Bus(interface="socketcan", channel="vcan0") as other:
        for _ in range(500):
            other.send(can.Message(arbitration_id=0x7F0, is_extended_id=False, data=bytes(8)))
    # sending took the emulated processor long: a node may have missed our heartbeat meanwhile
    assert bench.until(lambda s: s.fresh).outcome is Outcome.OK


def test_an_error_frame_of_bus_off_closes_the_bus_and_it_comes_back(bench: Bench) -> None:
    bench.until(lambda s: s.fresh)
    bus_off = can.Message(arbitration_id=0x40, is_error_frame=True, data=bytes(8))
    with can.Bus(interface="socketcan", channel="vcan0") as other:
        other.send(bus_off)
        bench.until(lambda s: s.outcome is Outcome.NOT_CONNECTED)
    bench.until(lambda s: s.fresh)


def test_a_29_bit_twin_of_our_identifier_is_another_frame(bench: Bench) -> None:
    bench.until(lambda s: s.fresh)
    with can.Bus(interface="socketcan", channel="vcan0") as other:
        for can_id, _ in bench.gateway._ours:
            other.send(can.Message(arbitration_id=can_id, is_extended_id=True, data=bytes(8)))
        for _ in range(20):
            assert bench.tick().outcome is not Outcome.BAD_REPLY
    assert bench.gateway.foreign == 0
