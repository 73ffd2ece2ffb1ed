"""Site file to register map and Modbus connection."""

from __future__ import annotations

import ssl
from collections.abc import Callable, Mapping
from pathlib import Path

from aff_runtime.base.errors import ConfigError
from aff_runtime.base.ports import Clock, Gateway
from aff_runtime.config.can_wire import can_map_of, network_of
from aff_runtime.config.models import CanDbc, Channel, Site, Tls
from aff_runtime.fieldbus.catalogue import modbus_rtu, modbus_tcp, rtu_wire, tcp_wire
from aff_runtime.fieldbus.modbus.codec import WordCodec
from aff_runtime.fieldbus.modbus.frames import WireFunction
from aff_runtime.fieldbus.modbus.gateway import WordGateway
from aff_runtime.fieldbus.modbus.registers import (
    Correction,
    Register,
    RegisterMap,
    WordOrder,
    WordType,
)
from aff_runtime.fieldbus.modbus.tcp import ModbusTcpTransport
from aff_runtime.fieldbus.modbus.tcp_wire import Wire
from aff_runtime.fieldbus.modbus.tls_wire import client_context


def gateway_of(
    site: Site, wire_files: Mapping[str, str], clock: Clock, folder: Path = Path()
) -> Gateway:
    """Return the wire in SI, whichever the site names; it connects within the ticks.

    Raises
    ------
    AffError
        A name cannot be resolved, or a file of the wire cannot be used.
    """
    can = site.gateway.can
    if can is not None:
        from aff_runtime.fieldbus import can_catalogue  # noqa: PLC0415 (needs the extra)

        bus = can_catalogue.BusSite(
            interface=can.interface, channel=can.channel, bitrate=can.bitrate
        )
        if isinstance(can, CanDbc):
            period_ns = round(site.cycle_s * 1e9)
            can_map = can_map_of(site, dict(wire_files))
            return can_catalogue.can_gateway(can_map, bus, clock, period_ns=period_ns)
        return can_catalogue.canopen_gateway(
            network_of(site, dict(wire_files)),
            bus,
            clock,
            own_node=can.own_node,
            heartbeat_ms=can.heartbeat_ms,
        )
    words = register_map(site)
    connection = transport(site, words, clock, folder)
    return WordGateway(connection, WordCodec(words), clock, lambda: connection.trouble)


def register_map(site: Site) -> RegisterMap:
    """Return every word that is read and written; channels in the order of the site file."""
    read, write = site.gateway.read, site.gateway.write
    address, aff_echo = _address(site), read.aff_echo
    return RegisterMap(
        plc_heartbeat=address(read.plc_heartbeat.register_number),
        status=address(read.status.register_number),
        roll_id=address(read.roll_id.register_number),
        channels=tuple(_channel(site, name, c) for name, c in read.channels.items()),
        aff_heartbeat=address(write.aff_heartbeat.register_number),
        state=address(write.state.register_number),
        echo=address(write.echo.register_number),
        alarm=address(write.alarm.register_number),
        limit=address(write.limit.register_number),
        config_revision=address(write.config_revision.register_number),
        aff_echo=None if aff_echo is None else address(aff_echo.register_number),
        corrections=tuple(_correction(site, name) for name in site.actuators),
    )


def transport(site: Site, words: RegisterMap, clock: Clock, folder: Path) -> ModbusTcpTransport:
    """Return the connection to the PLC; it connects by and by, within the ticks."""
    rtu, tcp = site.gateway.modbus_rtu, site.gateway.modbus_tcp
    if rtu is not None:
        return modbus_rtu(
            device=rtu.device,
            baud=rtu.baud,
            parity=rtu.parity[0].upper(),
            stop_bits=rtu.stop_bits,
            device_id=rtu.device_id,
            register_map=words,
            clock=clock,
            function=WireFunction(rtu.function),
        )
    if tcp is None:
        raise ConfigError("gateway: no modbus_tcp")
    return modbus_tcp(
        host=tcp.host,
        port=tcp.port,
        device_id=tcp.device_id,
        register_map=words,
        clock=clock,
        function=WireFunction(tcp.function),
        tls=_tls_context(tcp.tls, folder),
        server_name=_server_name(tcp.tls),
    )


def wire_of(site: Site, folder: Path) -> Wire:
    """Return the bare byte stream of a site on Modbus: serial, TLS or TCP; not connected yet.

    Raises
    ------
    AffError
        A name cannot be resolved, or a file of the wire cannot be used.
    """
    rtu, tcp = site.gateway.modbus_rtu, site.gateway.modbus_tcp
    if rtu is not None:
        parity = rtu.parity[0].upper()
        return rtu_wire(rtu.device, baud=rtu.baud, parity=parity, stop_bits=rtu.stop_bits)
    if tcp is None:
        raise ConfigError("gateway: no modbus_tcp")
    return tcp_wire(tcp.host, tcp.port, _tls_context(tcp.tls, folder), _server_name(tcp.tls))


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


def _channel(site: Site, name: str, channel: Channel) -> Register:
    """Return one measured value."""
    return Register(
        name=name,
        address=_address(site)(channel.register_number),
        type=WordType(channel.type or "u16"),
        scale=channel.scale,
        word_order=WordOrder(site.gateway.word_order or "high_first"),
        wraps=channel.wraps,
    )


def _correction(site: Site, actuator: str) -> Correction:
    """Return the correction word of one actuator and its complement."""
    correction = site.gateway.write.corrections[actuator]
    return Correction(
        register=Register(
            name=actuator,
            address=_address(site)(correction.register_number),
            type=WordType(correction.type),
            scale=correction.scale,
        ),
        complement_address=_address(site)(correction.complement),
    )


def _address(site: Site) -> Callable[[int | None], int]:
    """Return how a register number becomes a wire address; rules see that it is given."""
    return lambda register: site.gateway.wire_address(register or 0)
