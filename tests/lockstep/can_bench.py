"""The same bench on CAN by DBC: what plant and runtime say to each other are frames."""

from __future__ import annotations

from pathlib import Path

from aff_runtime.base.ports import Gateway
from aff_runtime.config.can_wire import can_map_of, wire_files
from aff_runtime.config.models.site import Site
from aff_runtime.fieldbus.can.gateway import CanGateway
from aff_runtime.fieldbus.can.reader import CanReader
from aff_runtime.fieldbus.can.writer import CanWriter
from sim_plant.servers.can_catalogue import can_node
from tests.doubles.can_lockstep import LockstepBus
from tests.lockstep.bench import Bench, Setup


class CanBench(Bench):
    """Plant and runtime on a bus; ``can_map`` names the plant's signals, the DBC is beside it."""

    def __init__(self, setup: Setup, can_map: Path) -> None:
        self._can_map = can_map
        super().__init__(setup)

    def _gateway(self, site: Site, setup: Setup) -> Gateway:
        bus = LockstepBus(self.wire, can_node(self.plant, "dbc", self._can_map), self.clock)
        signals = can_map_of(site, wire_files(site, setup.site.parent))
        return CanGateway(bus, CanReader(signals), CanWriter(signals), self.clock)

    def run(self, seconds: float) -> None:
        """Let runtime and plant live; the PLC sends its frames by itself, scan by scan."""
        end_ns = self.clock.now_ns() + round(seconds * 1e9)
        while self.clock.now_ns() < end_ns - self.period_ns // 2:
            self._transport.live()
            if not self.cycle.tick():
                break
        assert not self.outside.faults, self.outside.faults
