"""Line controller and CiA 402 drives on a bus: the canopen package's own nodes, wired by hand.

LocalNode answers SDO; what it does not do by itself is done here: PDOs on SYNC, received PDOs
acting on the SYNC that follows, heartbeats, the deadline of RPDOs, the loss of our master.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

from pydantic import BaseModel, ConfigDict, ValidationError

from aff_runtime.base.errors import PlantError
from sim_plant.line.yaml_file import load_yaml
from sim_plant.servers.can_frames import CanFrame
from sim_plant.servers.canopen_device import Bench, Device, NodeRow, maps
from sim_plant.servers.faults import Fault
from sim_plant.servers.plant import Plant
from sim_plant.servers.registers import Registers


class _Rows(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class ChannelRow(_Rows):
    """One measured channel: its object, SI per count, how the count is stored."""

    node: str
    object: int
    scale: float
    bits: int
    wraps: bool = False


class WordRow(_Rows):
    """One word or correction: its object."""

    node: str
    object: int


class NodeMap(_Rows):
    """Which object of which node carries what."""

    version: int
    nodes: Mapping[str, NodeRow]
    read: Mapping[str, WordRow]
    channels: Mapping[str, ChannelRow]
    write: Mapping[str, WordRow]
    corrections: Mapping[str, WordRow]
    applied: Mapping[str, ChannelRow] = {}


class CanopenNetwork:
    """PLC and drives; the PLC's rules decide what a correction is worth, as on every wire.

    A SYNC makes received data act and transmitted data leave. The PLC's words change only when
    every RPDO has come since the last SYNC, all nodes work and none has lost its master.

    Attributes
    ----------
    channels : measured channels that it shows.
    """

    def __init__(self, path: Path, registers: Registers) -> None:
        try:
            self._rows = NodeMap.model_validate(load_yaml(path)[0])
            self._network = Bench()
            self._devices = {
                name: Device(name, row, path.parent, self._network)
                for name, row in self._rows.nodes.items()
            }
        except (OSError, ValidationError, ValueError) as error:
            raise PlantError(f"{path}: {error}") from error
        self.channels = frozenset(self._rows.channels)
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
                    for pdo in maps(device.node.rpdo):
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
            for pdo in maps(device.node.rpdo)
            if pdo.enabled and pdo.cob_id
        ]

    def _on_sync(self, plant: Plant) -> None:
        working = all(d.operational for d in self._devices.values())
        lost = [d.lost(self._now_s, self._master_lost(d)) for d in self._devices.values()]
        whole = all(
            {p.cob_id for p in maps(d.node.rpdo) if p.enabled} <= d.arrived
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
                for pdo in maps(device.node.tpdo):
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
            self._set(row.node, row.object, _counts(plant.shown.measured[name] / row.scale, row))
        for name, row in self._rows.applied.items():
            self._set(
                row.node, row.object, _signed(plant.shown.applied_m_s[name] / row.scale, row)
            )

    def _set(self, node: str, index: int, value: int) -> None:
        device = self._devices[node]
        for pdo in maps(device.node.tpdo) if device.operational else ():
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

    def _got(self, word: WordRow) -> int:
        for pdo in maps(self._devices[word.node].node.rpdo):
            for variable in pdo.map:
                if variable.index == word.object:
                    return int(variable.raw)
        return 0

    def _master_lost(self, device: Device) -> bool:
        """Return whether the node's heartbeat consumer has given its master up."""
        entry = device.number(0x1016, 1)
        producer, limit_s = entry >> 16 & 0x7F, (entry & 0xFFFF) * 1e-3
        if not producer or limit_s <= 0.0 or producer not in self._heard_s:
            return False  # the consumer starts with the first heartbeat it hears
        return self._now_s - self._heard_s[producer] > limit_s + 1e-9

    def _collect(self) -> list[CanFrame]:
        out, self._network.out = self._network.out, []
        return out


def _signed(value: float, row: ChannelRow) -> int:
    """Return counts of what is applied, which PLC code of the user's may say as it likes."""
    half = 1 << (row.bits - 1)
    return -half if math.isnan(value) else round(min(max(value, -half), half - 1))


def _counts(value: float, row: ChannelRow) -> int:
    """Return counts as the object can hold them: wrapped, or at the end of its range."""
    half = 1 << (row.bits - 1)
    if math.isnan(value):
        return -half if row.bits == 32 else 2 * half - 1
    if row.wraps and math.isfinite(value):
        return (round(value) + half) % (2 * half) - half
    low, high = (-half, half - 1) if row.bits == 32 else (0, 2 * half - 1)
    return round(min(max(value, low), high))
