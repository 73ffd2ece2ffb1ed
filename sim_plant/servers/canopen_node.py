"""Line controller and CiA 402 drives on a bus: the canopen package's own nodes, wired by hand.

LocalNode answers SDO; what it does not do by itself is done here: PDOs on SYNC, received PDOs
acting on the SYNC that follows, heartbeats, the deadline of RPDOs, the loss of our master.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import canopen
import yaml
from pydantic import BaseModel, ConfigDict, ValidationError

from aff_runtime.base.errors import PlantError
from sim_plant.servers.can_frames import CanFrame
from sim_plant.servers.faults import Fault
from sim_plant.servers.plant import Plant
from sim_plant.servers.registers import Registers

_OPERATIONAL = 5
_RPDO_TIMEOUT = 0x8250
_HEARTBEAT_LOST = 0x8130


class _Rows(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class _Channel(_Rows):
    node: str
    object: int
    scale: float
    bits: int
    wraps: bool = False


class _Word(_Rows):
    node: str
    object: int


class _Node(_Rows):
    id: int
    eds: str


class NodeMap(_Rows):
    """Which object of which node carries what."""

    version: int
    nodes: Mapping[str, _Node]
    read: Mapping[str, _Word]
    channels: Mapping[str, _Channel]
    write: Mapping[str, _Word]
    corrections: Mapping[str, _Word]


class _Bench(canopen.Network):
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


class _Device:
    """One node: the package's own SDO server and PDO maps, and what it must do on its own."""

    def __init__(self, name: str, row: _Node, folder: Path, network: _Bench) -> None:
        self.name = name
        self.id = row.id
        self._network = network
        od = canopen.import_od(str(folder / row.eds), row.id)
        self.node = network.create_node(canopen.LocalNode(row.id, od))
        self.boot()

    def boot(self) -> None:
        """Start again with the EDS' defaults, in PRE-OPERATIONAL."""
        self.node.data_store.clear()
        self.operational = False
        self.received_s = -math.inf
        self.heard_master_s = -math.inf
        self.emcy = 0
        self.beat_s = -math.inf
        self.arrived: set[int] = set()
        self.node.nmt.state = "INITIALISING"
        self._network.send_message(0x700 + self.id, b"\0")
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
            data = code.to_bytes(2, "little") + bytes((register, 0, 0, 0, 0, 0))
            self._network.send_message(0x80 + self.id, data)

    def lost(self, now_s: float, master_lost: bool) -> bool:
        """Return whether master or process data are missing; raises or clears the EMCY."""
        limit_s = (
            self.number(0x1400, 5) * 1e-3 if 5 in self.node.object_dictionary[0x1400] else 0.0
        )
        late = limit_s > 0.0 and now_s - self.received_s > limit_s
        if self.operational and math.isfinite(self.received_s):
            self.report(_HEARTBEAT_LOST if master_lost else _RPDO_TIMEOUT if late else 0)
        return late or master_lost


class CanopenNetwork:
    """PLC and drives; the PLC's rules decide what a correction is worth, as on every wire.

    A SYNC makes received data act and transmitted data leave. The PLC's words change only when
    every RPDO has come since the last SYNC, all nodes work and none has lost its master.
    """

    needs_sync = True

    def __init__(self, path: Path, registers: Registers) -> None:
        try:
            self._rows = NodeMap.model_validate(yaml.safe_load(path.read_text(encoding="utf-8")))
            self._network = _Bench()
            self._devices = {
                name: _Device(name, row, path.parent, self._network)
                for name, row in self._rows.nodes.items()
            }
        except (OSError, yaml.YAMLError, ValidationError, ValueError) as error:
            raise PlantError(f"{path}: {error}") from error
        self._registers = registers
        self._plant: Plant | None = None
        self._now_s = 0.0
        self._heard_s: dict[int, float] = {}
        self._frozen: list[CanFrame] = []

    def reset(self) -> list[CanFrame]:
        """Boot every node."""
        for device in self._devices.values():
            device.boot()
        self._heard_s.clear()
        return self._collect()

    def take(self, frame: CanFrame) -> list[CanFrame]:
        """Take a frame of the master."""
        can_id, data = frame.can_id, frame.data
        if frame.extended:
            return []
        if can_id == 0x000 and len(data) == 2:
            for device in self._devices.values():
                if data[1] in (0, device.id):
                    device.command(data[0])
        elif can_id == 0x080 and self._plant is not None:
            if not self._plant.faults.active(Fault.SYNC):
                self._on_sync(self._plant)
        elif 0x700 < can_id <= 0x77F:
            self._heard_s[can_id - 0x700] = self._now_s
        else:
            self._network.notify(can_id, bytearray(data), self._now_s)
            for device in self._devices.values():
                if device.operational:
                    for pdo in device.node.rpdo.map.values():
                        if pdo.cob_id == can_id and pdo.enabled:
                            device.arrived.add(can_id)
                            device.received_s = self._now_s
        return self._collect()

    def publish(self, plant: Plant) -> list[CanFrame]:
        """Return heartbeats and emergencies of one sample; process data wait for SYNC."""
        self._plant = plant
        self._now_s = plant.time_s
        for device in self._devices.values():
            device.beat(self._now_s)
            device.lost(self._now_s, self._master_lost(device))
        return self._collect()

    def second_master(self) -> list[CanFrame]:
        """Return RPDOs that are all zero, from somebody else."""
        return [
            CanFrame(pdo.cob_id, False, bytes(sum(v.length for v in pdo.map) // 8))
            for device in self._devices.values()
            if device.operational
            for pdo in device.node.rpdo.map.values()
            if pdo.enabled and pdo.cob_id
        ]

    def _on_sync(self, plant: Plant) -> None:
        working = all(d.operational for d in self._devices.values())
        lost = [d.lost(self._now_s, self._master_lost(d)) for d in self._devices.values()]
        whole = all(
            {p.cob_id for p in d.node.rpdo.map.values() if p.enabled} <= d.arrived
            for d in self._devices.values()
        )
        if working and whole and not any(lost):
            self._accept()
        if whole:
            for device in self._devices.values():
                device.arrived.clear()
        if plant.faults.active(Fault.FREEZE) and self._frozen:
            self._network.out.extend(self._frozen)
            return
        self._sample(plant)
        self._frozen = []
        for device in self._devices.values():
            if device.operational:
                for pdo in device.node.tpdo.map.values():
                    if pdo.enabled and pdo.trans_type <= 240:
                        self._frozen.append(CanFrame(pdo.cob_id, False, bytes(pdo.data)))
        self._frozen.sort()
        self._network.out.extend(self._frozen)

    def _sample(self, plant: Plant) -> None:
        """Put measured values and the PLC's words into the nodes' TPDOs."""
        plc_map, words = plant.plc.map, plant.registers.read_words
        shown = {name: words[at - plc_map.read_start] for name, at in plc_map.read.items()}
        for name, word in self._rows.read.items():
            self._set(word.node, word.object, shown[name])
        for name, row in self._rows.channels.items():
            self._set(row.node, row.object, _counts(plant.measured[name] / row.scale, row))

    def _set(self, node: str, index: int, value: int) -> None:
        device = self._devices[node]
        for pdo in device.node.tpdo.map.values() if device.operational else ():
            for variable in pdo.map:
                if variable.index == index:
                    variable.raw = value

    def _accept(self) -> None:
        """Copy what the RPDOs carried into the PLC's write block."""
        plc_map = self._registers.plc_map
        block = list(self._registers.write_words)
        for name, word in self._rows.write.items():
            value = self._got(word)
            block[plc_map.write[name] - plc_map.write_start] = value & 0xFFFF
        for row in plc_map.corrections:
            value = self._got(self._rows.corrections[row.item.name])
            value = min(max(value, -0x8000), 0x7FFF)
            block[row.item.address - plc_map.write_start] = value & 0xFFFF
            block[row.complement_address - plc_map.write_start] = ~value & 0xFFFF
        self._registers.write(plc_map.write_start, block)

    def _got(self, word: _Word) -> int:
        for pdo in self._devices[word.node].node.rpdo.map.values():
            for variable in pdo.map:
                if variable.index == word.object:
                    return int(variable.raw)
        return 0

    def _master_lost(self, device: _Device) -> bool:
        """Return whether the node's heartbeat consumer has given its master up."""
        entry = device.number(0x1016, 1)
        producer, limit_s = entry >> 16 & 0x7F, (entry & 0xFFFF) * 1e-3
        if not producer or limit_s <= 0.0 or producer not in self._heard_s:
            return False  # the consumer starts with the first heartbeat it hears
        return self._now_s - self._heard_s[producer] > limit_s + 1e-9

    def _collect(self) -> list[CanFrame]:
        out, self._network.out = self._network.out, []
        return out


def _counts(value: float, row: _Channel) -> int:
    """Return counts as the object can hold them: wrapped, or at the end of its range."""
    half = 1 << (row.bits - 1)
    if math.isnan(value):
        return -half if row.bits == 32 else 2 * half - 1
    if row.wraps and math.isfinite(value):
        return (round(value) + half) % (2 * half) - half
    low, high = (-half, half - 1) if row.bits == 32 else (0, 2 * half - 1)
    return round(min(max(value, low), high))
