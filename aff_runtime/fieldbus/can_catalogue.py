"""CAN gateways by the name of their interface; only sites on CAN import this."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any

from aff_runtime.base.ports import Clock
from aff_runtime.base.python_can import can
from aff_runtime.fieldbus.can.frame_socket import FrameSocketBus
from aff_runtime.fieldbus.can.gateway import CanGateway
from aff_runtime.fieldbus.can.layout import CanMap
from aff_runtime.fieldbus.can.link import PythonCanLink
from aff_runtime.fieldbus.can.phase_lock import PhaseLock
from aff_runtime.fieldbus.can.reader import CanReader
from aff_runtime.fieldbus.can.slcan_tty import SlcanTtyBus
from aff_runtime.fieldbus.can.writer import CanWriter
from aff_runtime.fieldbus.canopen.device_402 import Network
from aff_runtime.fieldbus.canopen.link import CanopenLink, managed_ids
from aff_runtime.fieldbus.scan_edge import ScanEdge


def open_bus(
    interface: str, channel: str, bitrate: int, ids: tuple[tuple[int, bool], ...]
) -> can.BusABC:
    """Open a bus that hears ``ids`` alone (and error frames, where the driver has them).

    SocketCAN filters in the kernel; the bit rate of its interface is the system's. A driver that
    cannot filter brings every frame: python-can would filter for it, and say of each frame of
    somebody else what it says of an empty bus.

    Raises
    ------
    can.CanError, OSError, ValueError
        The interface cannot be opened.
    """
    if interface == "slcan_tty":
        return SlcanTtyBus(channel, bitrate)
    if interface == "frame_socket":
        return FrameSocketBus(channel)
    filters: Any = [
        {"can_id": can_id, "can_mask": 0x1FFFFFFF if ext else 0x7FF, "extended": ext}
        for can_id, ext in ids
    ]
    bus = can.Bus(interface=interface, channel=channel, can_filters=filters)
    if not getattr(bus, "_is_filtered", False):  # SocketCAN's word for "the kernel does it"
        bus.set_filters(None)
    return bus


@dataclass(frozen=True, slots=True, kw_only=True)
class BusSite:
    """Which bus: driver, its channel, bit/s."""

    interface: str
    channel: str
    bitrate: int


def can_gateway(
    can_map: CanMap,
    bus: BusSite,
    clock: Clock,
    *,
    period_ns: int = 0,
    command_life_s: float = 0.080,
) -> CanGateway:
    """Return the gateway of a map; the bus is opened by its first ticks.

    The PLC sends when its own scan says so: ticks of ``period_ns`` are locked to that; 0 locks
    nothing.
    """
    reader, writer = CanReader(can_map), CanWriter(can_map)
    link = _link(bus, (*reader.ids, *writer.ids), clock)
    lock = PhaseLock(period_ns) if period_ns else None
    return CanGateway(link, reader, writer, clock, lock, command_life_s=command_life_s)


def canopen_gateway(
    network: Network,
    bus: BusSite,
    clock: Clock,
    *,
    own_node: int,
    heartbeat_ms: int,
    period_ns: int = 0,
    command_life_s: float = 0.080,
) -> CanGateway:
    """Return the gateway of a CANopen network; its nodes are configured within the ticks.

    Nodes answer to our SYNC: ticks of ``period_ns`` are kept off the edge of the PLC's scan; 0
    moves nothing.
    """
    reader, writer = CanReader(network.can_map), CanWriter(network.can_map)
    managed = managed_ids(network.plans, own_node)
    link = CanopenLink(
        _link(bus, (*reader.ids, *writer.ids, *managed), clock),
        network.plans,
        own_node=own_node,
        heartbeat_ms=heartbeat_ms,
        clock=clock,
    )
    edge = ScanEdge(period_ns, reader.heartbeat_modulus) if period_ns else None
    return CanGateway(link, reader, writer, clock, edge=edge, command_life_s=command_life_s)


def _link(bus: BusSite, ids: tuple[tuple[int, bool], ...], clock: Clock) -> PythonCanLink:
    return PythonCanLink(partial(open_bus, bus.interface, bus.channel, bus.bitrate, ids), clock)
