"""One CANopen node of the plant: the canopen package's own, without a bus and without threads."""

from __future__ import annotations

import io
import math
from pathlib import Path
from typing import Any

import canopen
from pydantic import BaseModel, ConfigDict

from aff_runtime.base.effort import bounded_effort
from aff_runtime.base.errors import PlantError
from aff_runtime.base.printable import printable
from sim_plant.base.plain_file import read_plain
from sim_plant.line.yaml_file import LONGEST_BYTES
from sim_plant.servers.can_frames import CanFrame

_OPERATIONAL = 5
_RPDO_TIMEOUT = 0x8250
_HEARTBEAT_LOST = 0x8130


class NodeRow(BaseModel):
    """Node id and EDS file of one device."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    id: int
    eds: str


class Bench(canopen.Network):
    """A network without a bus: what nodes send is collected."""

    def __init__(self) -> None:
        super().__init__(None)
        self.out: list[CanFrame] = []

    def send_message(self, can_id: int, data: bytes, remote: bool = False) -> None:
        """Collect a frame."""
        if not remote:
            self.out.append(CanFrame(can_id, False, bytes(data)))

    def send_periodic(self, can_id: int, data: Any, period: float, remote: bool = False) -> Any:
        """Start nothing: heartbeats are sent from ``publish``."""
        return _NoTask()


class _NoTask:
    def stop(self) -> None:
        """Do nothing."""

    def update(self, data: Any) -> None:
        """Do nothing."""


class Device:
    """One node: the package's own SDO server and PDO maps, and what it must do on its own."""

    def __init__(self, name: str, row: NodeRow, folder: Path, network: Bench) -> None:
        self.name = name
        self.id = row.id
        self._network = network
        od = _dictionary(folder / row.eds, row.id)
        self.node: Any = canopen.LocalNode(row.id, od)
        network[row.id] = self.node
        self._timed = od.get_variable(0x1400, 5) is not None
        self.boot()

    def boot(self) -> None:
        """Start again with the EDS' defaults, in PRE-OPERATIONAL."""
        self.node.data_store.clear()
        self.operational = False
        self.received_s = -math.inf
        self.emcy = 0
        self.beat_s = -math.inf
        self.arrived: set[int] = set()
        self.node.nmt.state = "INITIALISING"
        self.node.nmt.state = "PRE-OPERATIONAL"

    def number(self, index: int, subindex: int = 0) -> int:
        """Return an object as it is now."""
        data = self.node.get_data(index, subindex)
        return int.from_bytes(data, "little")

    def command(self, code: int) -> None:
        """Obey an NMT command."""
        if code == 1 and not self.operational:
            self.node.tpdo.read()
            self.node.rpdo.read()
            self.operational = True
            self.node.nmt.state = "OPERATIONAL"
        elif code in (0x02, 0x80):
            self.operational = False
            self.node.nmt.state = "PRE-OPERATIONAL"
        elif code in (0x81, 0x82):
            self.boot()

    def beat(self, now_s: float) -> None:
        """Send the heartbeat when its time has come."""
        period_s = self.number(0x1017) * 1e-3
        if period_s > 0.0 and now_s - self.beat_s >= period_s - 1e-9:
            self.beat_s = now_s
            state = _OPERATIONAL if self.operational else 0x7F
            self._network.send_message(0x700 + self.id, bytes((state,)))

    def report(self, code: int) -> None:
        """Send an EMCY when the error changes."""
        if code != self.emcy:
            self.emcy = code
            register = 0x11 if code else 0
            self.node.set_data(0x1001, 0, bytes((register,)))
            data = code.to_bytes(2, "little") + bytes((register, 0, 0, 0, 0, 0))
            self._network.send_message(0x80 + self.id, data)

    def lost(self, now_s: float, master_lost: bool) -> bool:
        """Return whether master or process data are missing; raises or clears the EMCY."""
        limit_s = self.number(0x1400, 5) * 1e-3 if self._timed else 0.0
        late = limit_s > 0.0 and now_s - self.received_s > limit_s
        if self.operational and math.isfinite(self.received_s):
            self.report(_HEARTBEAT_LOST if master_lost else _RPDO_TIMEOUT if late else 0)
        return late or master_lost


def _dictionary(path: Path, node_id: int) -> Any:
    """Return the object dictionary of an EDS file; PlantError when it is too much to read."""
    text = io.StringIO(read_plain(path, LONGEST_BYTES).decode("utf-8", "replace"))
    text.name = "text.eds"  # canopen tells the format by the ending
    with bounded_effort(printable(str(path)), PlantError):
        return canopen.import_od(text, node_id)


def maps(pdos: Any) -> list[Any]:
    """Return the PDO maps of one direction."""
    return list(pdos.map.maps.values())
