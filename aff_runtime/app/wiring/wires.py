"""Every way to reach a PLC that a site file can name: one row each; the row makes it."""

from __future__ import annotations

import ssl
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from aff_runtime.app.wiring.site_to_wire import register_map
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.ports import Clock, Gateway
from aff_runtime.config.can_wire import can_map_of, network_of
from aff_runtime.config.models import Site, Tls
from aff_runtime.fieldbus.modbus.codec import WordCodec
from aff_runtime.fieldbus.modbus.connections import modbus_rtu, modbus_tcp, rtu_wire, tcp_wire
from aff_runtime.fieldbus.modbus.frames import WireFunction
from aff_runtime.fieldbus.modbus.gateway import WordGateway
from aff_runtime.fieldbus.modbus.registers import RegisterMap
from aff_runtime.fieldbus.modbus.tcp import ModbusTcpTransport
from aff_runtime.fieldbus.modbus.tcp_wire import Wire as ByteStream
from aff_runtime.fieldbus.modbus.tls_wire import client_context


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


Transport = Callable[[Wiring, RegisterMap], ModbusTcpTransport]


@dataclass(frozen=True, slots=True, kw_only=True)
class Wire:
    """One row.

    Attributes
    ----------
    key : in the site file, under ``gateway``.
    gateway : makes the wire in SI; it connects by and by, within the ticks.
    transport, stream : on Modbus, what carries words and what carries bytes; None elsewhere.
    """

    key: str
    text: str
    gateway: Callable[[Wiring], Gateway]
    transport: Transport | None = None
    stream: Callable[[Site, Path], ByteStream] | None = None


def gateway_of(
    site: Site, wire_files: Mapping[str, str], clock: Clock, folder: Path = Path()
) -> Gateway:
    """Return the wire in SI, whichever the site names; it connects within the ticks.

    Raises
    ------
    AffError
        A name cannot be resolved, or a file of the wire cannot be used.
    """
    return WIRES[site.gateway.wire].gateway(
        Wiring(site=site, files=wire_files, clock=clock, folder=folder)
    )


def transport(site: Site, words: RegisterMap, clock: Clock, folder: Path) -> ModbusTcpTransport:
    """Return the connection to a PLC on Modbus; it connects by and by, within the ticks.

    Raises
    ------
    AffError
        A name cannot be resolved, a file cannot be used, or the site is not on Modbus.
    """
    make = WIRES[site.gateway.wire].transport
    if make is None:
        raise ConfigError(f"gateway: {site.gateway.wire} carries no words")
    return make(Wiring(site=site, files={}, clock=clock, folder=folder), words)


def wire_of(site: Site, folder: Path) -> ByteStream:
    """Return the bare byte stream of a site on Modbus: serial, TLS or TCP; not connected yet.

    Raises
    ------
    AffError
        A name cannot be resolved, a file cannot be used, or the site is not on Modbus.
    """
    make = WIRES[site.gateway.wire].stream
    if make is None:
        raise ConfigError(f"gateway: {site.gateway.wire} is no stream of bytes")
    return make(site, folder)


def _words(make: Transport) -> Callable[[Wiring], Gateway]:
    """Return how a transport of words becomes the wire in SI."""

    def gateway(wiring: Wiring) -> Gateway:
        words = register_map(wiring.site)
        connection = make(wiring, words)
        return WordGateway(connection, WordCodec(words), wiring.clock, lambda: connection.trouble)

    return gateway


def _tcp(wiring: Wiring, words: RegisterMap) -> ModbusTcpTransport:
    tcp = wiring.site.gateway.modbus_tcp
    assert tcp is not None  # by the row's key
    return modbus_tcp(
        host=tcp.host,
        port=tcp.port,
        device_id=tcp.device_id,
        register_map=words,
        clock=wiring.clock,
        function=WireFunction(tcp.function),
        tls=_tls_context(tcp.tls, wiring.folder),
        server_name=_server_name(tcp.tls),
    )


def _tcp_stream(site: Site, folder: Path) -> ByteStream:
    tcp = site.gateway.modbus_tcp
    assert tcp is not None  # by the row's key
    return tcp_wire(tcp.host, tcp.port, _tls_context(tcp.tls, folder), _server_name(tcp.tls))


def _rtu(wiring: Wiring, words: RegisterMap) -> ModbusTcpTransport:
    rtu = wiring.site.gateway.modbus_rtu
    assert rtu is not None  # by the row's key
    return modbus_rtu(
        device=rtu.device,
        baud=rtu.baud,
        parity=rtu.parity[0].upper(),
        stop_bits=rtu.stop_bits,
        device_id=rtu.device_id,
        register_map=words,
        clock=wiring.clock,
        function=WireFunction(rtu.function),
    )


def _rtu_stream(site: Site, _folder: Path) -> ByteStream:
    rtu = site.gateway.modbus_rtu
    assert rtu is not None  # by the row's key
    parity = rtu.parity[0].upper()
    return rtu_wire(rtu.device, baud=rtu.baud, parity=parity, stop_bits=rtu.stop_bits)


def _dbc(wiring: Wiring) -> Gateway:
    from aff_runtime.fieldbus import can_catalogue  # noqa: PLC0415 (needs the extra)

    can = wiring.site.gateway.can_dbc
    assert can is not None  # by the row's key
    bus = can_catalogue.BusSite(interface=can.interface, channel=can.channel, bitrate=can.bitrate)
    can_map = can_map_of(wiring.site, dict(wiring.files))
    period_ns = round(wiring.site.cycle_s * 1e9)
    return can_catalogue.can_gateway(can_map, bus, wiring.clock, period_ns=period_ns)


def _canopen(wiring: Wiring) -> Gateway:
    from aff_runtime.fieldbus import can_catalogue  # noqa: PLC0415 (needs the extra)

    can = wiring.site.gateway.canopen_402
    assert can is not None  # by the row's key
    bus = can_catalogue.BusSite(interface=can.interface, channel=can.channel, bitrate=can.bitrate)
    network = network_of(wiring.site, dict(wiring.files))
    return can_catalogue.canopen_gateway(
        network, bus, wiring.clock, own_node=can.own_node, heartbeat_ms=can.heartbeat_ms
    )


def _server_name(tls: Tls | None) -> str:
    return tls.server_name or "" if tls is not None else ""


def _tls_context(tls: Tls | None, folder: Path) -> ssl.SSLContext | None:
    """Return the certificates of a site, whose folder is where names begin; None without TLS."""
    if tls is None:
        return None
    return client_context(
        folder / tls.ca,
        folder / tls.certificate if tls.certificate is not None else None,
        folder / tls.private_key if tls.private_key is not None else None,
        folder / tls.crl if tls.crl is not None else None,
    )


_ROWS = (
    Wire(
        key="modbus_tcp",
        text="Modbus TCP client, FC23 or FC16 + FC3, in TLS when it is declared",
        gateway=_words(_tcp),
        transport=_tcp,
        stream=_tcp_stream,
    ),
    Wire(
        key="modbus_rtu",
        text="Modbus RTU master on a serial line",
        gateway=_words(_rtu),
        transport=_rtu,
        stream=_rtu_stream,
    ),
    Wire(key="can_dbc", text="CAN by the signals of a DBC file", gateway=_dbc),
    Wire(key="canopen_402", text="CANopen, drives of CiA 402", gateway=_canopen),
)
WIRES: Mapping[str, Wire] = {row.key: row for row in _ROWS}
