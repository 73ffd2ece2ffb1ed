"""CAN gateways by the name of their interface; only sites on CAN import this."""

from __future__ import annotations

from functools import partial
from typing import Any

import can

from aff_runtime.base.errors import ConfigError
from aff_runtime.base.ports import Clock
from aff_runtime.fieldbus.can_gateway import CanGateway
from aff_runtime.fieldbus.can_layout import CanMap
from aff_runtime.fieldbus.can_link import PythonCanLink
from aff_runtime.fieldbus.can_reader import CanReader
from aff_runtime.fieldbus.can_writer import CanWriter
from aff_runtime.fieldbus.slcan_tty import SlcanTtyBus


def open_bus(
    interface: str, channel: str, bitrate: int, ids: tuple[tuple[int, bool], ...]
) -> can.BusABC:
    """Open a bus that hears ``ids`` alone (and error frames, where the driver has them).

    SocketCAN filters in the kernel; the bit rate of its interface is the system's.

    Raises
    ------
    can.CanError, OSError, ValueError
        The interface cannot be opened.
    """
    if interface == "slcan_tty":
        return SlcanTtyBus(channel, bitrate)
    filters: Any = [
        {"can_id": can_id, "can_mask": 0x1FFFFFFF if ext else 0x7FF, "extended": ext}
        for can_id, ext in ids
    ]
    return can.Bus(interface=interface, channel=channel, can_filters=filters)


def can_gateway(
    *, can_map: CanMap, interface: str, channel: str, bitrate: int, clock: Clock
) -> CanGateway:
    """Return the gateway of a map; the bus is opened by its first ticks.

    Raises
    ------
    ConfigError
        The interface is not known.
    """
    if interface not in {"socketcan", "slcan_tty", "udp_multicast", "virtual"}:
        raise ConfigError(f"CAN interface {interface!r} is not known")
    reader, writer = CanReader(can_map), CanWriter(can_map)
    ids = (*reader.ids, *writer.ids)
    link = PythonCanLink(partial(open_bus, interface, channel, bitrate, ids), clock)
    return CanGateway(link, reader, writer, clock)
