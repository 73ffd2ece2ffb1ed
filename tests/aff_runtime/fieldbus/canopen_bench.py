"""The shipped CANopen site against the plant's nodes (the canopen package's own), in lockstep."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from aff_runtime.base.signals import Snapshot
from aff_runtime.config.can_wire import network_of, wire_files
from aff_runtime.config.loader import load_site
from aff_runtime.fieldbus.can.gateway import CanGateway
from aff_runtime.fieldbus.can.reader import CanReader
from aff_runtime.fieldbus.can.writer import CanWriter
from aff_runtime.fieldbus.canopen.link import CanopenLink
from sim_plant.servers.canopen_node import CanopenNetwork
from sim_plant.servers.faults import parse_fault
from sim_plant.servers.plc import Plc
from tests.aff_runtime.fieldbus.euclid_can import command
from tests.doubles.can_lockstep import LockstepBus
from tests.doubles.lockstep_plant import LockstepPlant
from tests.doubles.virtual_clock import VirtualClock
from tests.sim_plant.servers.fake_line import FakeLine, default_map

CONFIG = Path(__file__).parents[3] / "config"
SITE = load_site(CONFIG / "euclid_canopen.yaml")
NETWORK = network_of(SITE, wire_files(SITE, CONFIG))


class CanopenBench:
    def __init__(self, plc: Plc | None = None) -> None:
        self.clock = VirtualClock()
        self.lockstep = LockstepPlant(FakeLine(), plc or Plc(default_map()))
        self.node = CanopenNetwork(
            CONFIG / "plc" / "can_canopen.yaml", self.lockstep.plant.registers
        )
        self.bus = LockstepBus(self.lockstep, self.node, self.clock)
        self.link = CanopenLink(
            self.bus, NETWORK.plans, own_node=100, heartbeat_ms=20, clock=self.clock
        )
        self.gateway = CanGateway(
            self.link, CanReader(NETWORK.can_map), CanWriter(NETWORK.can_map), self.clock
        )
        self.ticks = 0

    def tick(self, corrections: tuple[float, float] = (0.0, 0.0)) -> Snapshot:
        self.ticks += 1
        self.lockstep.advance(0.005)
        self.clock.advance_ns(5_000_000)
        deadline_ns = self.clock.now_ns() + 3_000_000
        return self.gateway.exchange(command(self.ticks, corrections), self.ticks, deadline_ns)

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / 0.005)):
            self.tick()

    def fault(self, spec: str) -> None:
        self.lockstep.inject(parse_fault(spec))

    def device(self, name: str) -> Any:
        return self.node._devices[name]
