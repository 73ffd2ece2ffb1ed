"""Every way to reach a PLC that a site file can name: one row each, which makes its gateway."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from aff_runtime.app.wiring.site_to_wire import register_map
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.ports import Clock, Gateway
from aff_runtime.config.can_wire import can_map_of, network_of
from aff_runtime.config.models import Site
from aff_runtime.fieldbus.modbus.byte_stream import ByteStream
from aff_runtime.fieldbus.modbus.codec import WordCodec
from aff_runtime.fieldbus.modbus.connections import CONNECTIONS, Connection, modbus
from aff_runtime.fieldbus.modbus.frames import WireFunction
from aff_runtime.fieldbus.modbus.gateway import WordGateway
from aff_runtime.fieldbus.modbus.transport import silence_before_reconnect
from aff_runtime.fieldbus.scan_edge import ScanEdge


@dataclass(frozen=True, slots=True, kw_only=True)
class Wiring:
    """What a way to the PLC is made from.

    Attributes
    ----------
    files : texts of the files that describe the wire, by their name in the site file.
    folder : of the site file; names of certificates begin there.
    """

    site: Site
    files: Mapping[str, str]
    clock: Clock
    folder: Path

    @property
    def period_ns(self) -> int:
        """Time from one tick to the next, ns."""
        return round(self.site.cycle_s * 1e9)

    @property
    def command_life_s(self) -> float:
        """How old a command may be when it goes out, s."""
        return self.site.freshness.fault_after_ms * 1e-3


@dataclass(frozen=True, slots=True, kw_only=True)
class WireRow:
    """One row.

    Attributes
    ----------
    key : in the site file, under ``gateway``.
    gateway : makes the gateway, which reads and writes SI; it connects within the ticks.
    stream : on Modbus, what carries the bytes; None elsewhere.
    """

    key: str
    text: str
    gateway: Callable[[Wiring], Gateway]
    stream: Callable[[Site, Path], ByteStream] | None = None


def gateway_of(
    site: Site, wire_files: Mapping[str, str], clock: Clock, folder: Path = Path()
) -> Gateway:
    """Return the gateway of the wire that the site names; it connects within the ticks.

    Raises
    ------
    AffError
        A name cannot be resolved, or a file of the wire cannot be used.
    """
    return WIRES[site.gateway.wire].gateway(
        Wiring(site=site, files=wire_files, clock=clock, folder=folder)
    )


def wire_of(site: Site, folder: Path) -> ByteStream:
    """Return the bare byte stream of a site on Modbus; not connected yet.

    Raises
    ------
    AffError
        A name cannot be resolved, a file cannot be used, or the site is not on Modbus.
    """
    make = WIRES[site.gateway.wire].stream
    if make is None:
        raise ConfigError(f"gateway: {site.gateway.wire} carries no Modbus words")
    return make(site, folder)


def _words(wiring: Wiring) -> Gateway:
    """Return the gateway of a site on Modbus, whatever carries its bytes."""
    modbus_section = wiring.site.gateway.modbus
    assert modbus_section is not None  # by the row's key
    words = register_map(wiring.site)
    connection = modbus(
        wire_of(wiring.site, wiring.folder),
        device_id=modbus_section.device_id,
        register_map=words,
        clock=wiring.clock,
        function=WireFunction(modbus_section.function),
        silence_before_reconnect_s=silence_before_reconnect(
            wiring.site.cycle_s, wiring.site.freshness.fault_after_ms * 1e-3
        ),
    )
    return WordGateway(
        connection,
        WordCodec(words),
        wiring.clock,
        lambda: connection.trouble,
        lambda: connection.wrote,
        edge=ScanEdge(wiring.period_ns, WordGateway.heartbeat_modulus),
    )


def _on_modbus(key: str, row: Connection) -> WireRow:
    """Return the row of one way to carry Modbus words."""

    def stream(site: Site, folder: Path) -> ByteStream:
        return row.wire(site.gateway.modbus, folder)

    return WireRow(key=key, text=row.text, gateway=_words, stream=stream)


def _dbc(wiring: Wiring) -> Gateway:
    from aff_runtime.fieldbus import can_catalogue  # noqa: PLC0415 (needs the extra)

    can = wiring.site.gateway.can_dbc
    assert can is not None  # by the row's key
    bus = can_catalogue.BusSite(interface=can.interface, channel=can.channel, bitrate=can.bitrate)
    can_map = can_map_of(wiring.site, dict(wiring.files))
    return can_catalogue.can_gateway(
        can_map,
        bus,
        wiring.clock,
        period_ns=wiring.period_ns,
        command_life_s=wiring.command_life_s,
    )


def _canopen(wiring: Wiring) -> Gateway:
    from aff_runtime.fieldbus import can_catalogue  # noqa: PLC0415 (needs the extra)

    can = wiring.site.gateway.canopen_402
    assert can is not None  # by the row's key
    bus = can_catalogue.BusSite(interface=can.interface, channel=can.channel, bitrate=can.bitrate)
    network = network_of(wiring.site, dict(wiring.files))
    return can_catalogue.canopen_gateway(
        network,
        bus,
        wiring.clock,
        own_node=can.own_node,
        heartbeat_ms=can.heartbeat_ms,
        period_ns=wiring.period_ns,
        command_life_s=wiring.command_life_s,
    )


_ROWS = (
    *(_on_modbus(key, row) for key, row in CONNECTIONS.items()),
    WireRow(key="can_dbc", text="CAN by the signals of a DBC file", gateway=_dbc),
    WireRow(key="canopen_402", text="CANopen, drives of CiA 402", gateway=_canopen),
)
WIRES: Mapping[str, WireRow] = {row.key: row for row in _ROWS}
