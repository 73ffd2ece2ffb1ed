"""Against nodes of the canopen package on a real bus, with its own threads, SDO server and NMT.

They share nothing with the simulated plant but the EDS files: what a SYNC does is written here
with the package's own PDO maps.
"""

from __future__ import annotations

import asyncio
import struct
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import canopen
import pytest

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.signals import Outcome, Snapshot
from aff_runtime.config.can_wire import network_of, wire_files
from aff_runtime.config.loader import load_site
from aff_runtime.fieldbus.can.frame_socket import FrameSocketBus
from aff_runtime.fieldbus.can_catalogue import BusSite, canopen_gateway
from sim_plant.servers.frame_hub import FrameHub
from tests.aff_runtime.fieldbus.euclid_can import command

pytestmark = pytest.mark.wire
CONFIG = Path(__file__).parents[4] / "config"
NODES = {1: "euclid_line.eds", 3: "euclid_drive.eds", 4: "euclid_drive.eds"}
PATIENCE_TICKS = 2000


class Hub:
    """The bus alone: every frame to every other party."""

    def __init__(self, path: Path) -> None:
        self.ready = threading.Event()
        self.thread = threading.Thread(target=asyncio.run, args=(self._serve(path),))
        self.thread.start()
        assert self.ready.wait(10)

    async def _serve(self, path: Path) -> None:
        self.loop, self.end = asyncio.get_running_loop(), asyncio.Event()
        hub = FrameHub(path)
        hub.open(lambda frame: None)
        self.ready.set()
        await self.end.wait()
        hub.close()

    def close(self) -> None:
        self.loop.call_soon_threadsafe(self.end.set)
        self.thread.join(10)


class Nodes:
    """A line controller and two drives; on SYNC received data act, measured data leave."""

    def __init__(self, path: Path) -> None:
        self.network = canopen.Network(FrameSocketBus(str(path)))
        self.network.connect()
        self.beat = self.taken = 0
        self.offsets: dict[int, int] = {}
        self.started: set[int] = set()
        self.nodes: dict[int, Any] = {}
        for node_id, eds in NODES.items():
            od = canopen.import_od(str(CONFIG / eds), node_id)
            node: Any = canopen.LocalNode(node_id, od)
            self.network.add_node(node)
            self.nodes[node_id] = node
        self.network.subscribe(0x080, self._on_sync)
        for node in self.nodes.values():
            node.nmt.send_command(0x82)  # boot up: PRE-OPERATIONAL with a boot-up message

    def _on_sync(self, can_id: int, data: bytearray, timestamp: float) -> None:
        del can_id, data, timestamp
        self.beat = (self.beat + 1) & 0xFFFF
        for node_id, node in self.nodes.items():
            if node.nmt.state != "OPERATIONAL":
                self.started.discard(node_id)
                continue
            if node_id not in self.started:
                self.started.add(node_id)
                node.tpdo.read()
                node.rpdo.read()
            for pdo in node.tpdo.map.values():
                for variable in pdo.map:
                    value = self.measured(node_id, variable.index)
                    if value is not None:
                        variable.raw = value
                if pdo.enabled and pdo.cob_id:
                    self.network.send_message(pdo.cob_id, bytes(pdo.data))
            for pdo in node.rpdo.map.values():
                for variable in pdo.map:
                    if variable.index == 0x60B1:
                        self.offsets[node_id] = variable.raw
                    elif variable.index == 0x2100:
                        self.taken = variable.raw

    def measured(self, node_id: int, index: int) -> int | None:
        line = {0x2000: self.beat, 0x2001: 0x2F, 0x2002: 41, 0x2003: 9000, 0x2005: self.taken}
        unwind = {0x2010: 90_123, 0x606C: 10_160, 0x2011: 7500, 0x6064: 4096}
        follower = {0x2010: -1500, 0x606C: -5000, 0x6064: -2048}
        return {1: line, 3: unwind, 4: follower}[node_id].get(index)

    def close(self) -> None:
        for node in self.nodes.values():
            node.nmt.stop_heartbeat()
        self.network.disconnect()


class Bench:
    def __init__(self, folder: Path) -> None:
        path = folder / "can"
        self.hub = Hub(path)
        self.peer = Nodes(path)
        site = load_site(CONFIG / "euclid_canopen.yaml")
        self.clock = MonotonicClock()
        self.gateway = canopen_gateway(
            network_of(site, wire_files(site, CONFIG)),
            BusSite(interface="frame_socket", channel=str(path), bitrate=500_000),
            self.clock,
            own_node=100,
            heartbeat_ms=20,
        )
        self.ticks = 0

    def until(self, wanted: Callable[[Snapshot], bool]) -> Snapshot:
        for _ in range(PATIENCE_TICKS):
            self.ticks += 1
            now_ns = self.clock.now_ns()
            said = command(self.ticks, (-0.01234, 0.00002))
            shot = self.gateway.exchange(said, self.ticks, now_ns + 3_000_000)
            if wanted(shot):
                return shot
            self.clock.sleep_until_ns(now_ns + 5_000_000)
        raise AssertionError(f"never; last {shot}; {self.troubles}")

    @property
    def troubles(self) -> tuple[str, ...]:
        return self.gateway.troubles

    def close(self) -> None:
        self.gateway.close()
        self.peer.close()
        self.hub.close()


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    running = Bench(tmp_path)
    yield running
    running.close()


def test_the_package_s_nodes_are_configured_started_read_and_commanded(bench: Bench) -> None:
    shot = bench.until(lambda s: s.fresh)
    turn = 6.283185307179586
    wanted = (90.123, 90.0, 1.016, 0.15, -0.5, -1.5, turn, -turn / 2)
    assert shot.values == pytest.approx(wanted, rel=1e-9)
    assert (shot.status, shot.roll_id) == (0x2F, 41)
    assert bench.troubles == ()
    drive = bench.peer.nodes[3]
    assert drive.sdo[0x6007].raw == -1
    assert drive.sdo[0x1016][1].raw == 100 << 16 | 80
    assert drive.sdo[0x1017].raw == 50
    bench.until(lambda _: bench.peer.offsets == {3: -1234, 4: 2})
    assert 0 < bench.until(lambda s: s.fresh and s.echo_age < 50).echo_age < 50


def test_its_emergency_stops_the_values_until_it_is_taken_back(bench: Bench) -> None:
    bench.until(lambda s: s.fresh)
    bench.peer.nodes[3].emcy.send(0x2310, 0x02, struct.pack("5B", *range(5)))
    bench.until(lambda s: s.outcome is Outcome.NOT_CONNECTED)
    assert bench.troubles == ("unwind_drive (node 3): EMCY 0x2310",)
    bench.peer.nodes[3].emcy.reset(0)
    bench.until(lambda s: s.fresh)


def test_its_reset_is_seen_and_it_is_configured_again(bench: Bench) -> None:
    bench.until(lambda s: s.fresh)
    drive = bench.peer.nodes[4]
    drive.data_store.clear()
    drive.nmt.send_command(0x82)
    bench.until(lambda s: s.outcome is Outcome.NOT_CONNECTED)
    bench.until(lambda s: s.fresh)
    assert drive.sdo[0x1016][1].raw == 100 << 16 | 80
