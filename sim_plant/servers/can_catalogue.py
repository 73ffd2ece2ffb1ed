"""CAN nodes by the name of their protocol; only a plant on CAN imports this."""

from __future__ import annotations

from pathlib import Path

from aff_runtime.base.errors import PlantError
from sim_plant.servers.can_channel import channel_of
from sim_plant.servers.can_dbc_node import DbcNode, load_dbc_map
from sim_plant.servers.can_frames import CanNode
from sim_plant.servers.can_server import CanServer
from sim_plant.servers.canopen_node import CanopenNetwork
from sim_plant.servers.later import Later, in_real_time
from sim_plant.servers.plant import Plant
from sim_plant.servers.wire_faults import Medium, WireFaults

_MEDIA = {"dbc": Medium.DBC, "canopen": Medium.CANOPEN}


def can_node(plant: Plant, protocol: str, map_path: Path) -> CanNode:
    """Return PLC and drives on a bus.

    Raises
    ------
    PlantError
        The protocol is unknown or its files cannot be used.
    """
    if protocol == "dbc":
        rows, database = load_dbc_map(map_path)
        node: CanNode = DbcNode(rows, database, plant.registers)
    elif protocol == "canopen":
        node = CanopenNetwork(map_path, plant.registers)
    else:
        raise PlantError(f"--can {protocol}: known are dbc and canopen")
    plant.ask_for(node.channels)
    return node


def can_server(
    plant: Plant,
    protocol: str,
    map_path: Path,
    interface: str,
    channel: str,
    later: Later = in_real_time,
) -> CanServer:
    """Return the server of a plant on a bus."""
    node = can_node(plant, protocol, map_path)
    bus = channel_of(interface, channel)
    broken = WireFaults(
        medium=_MEDIA[protocol], channels=node.channels, tells_errors=bus.tells_errors
    )
    return CanServer(plant, node, bus, f"{interface} {channel}", broken, later)
