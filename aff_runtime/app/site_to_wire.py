"""Site file to register map and Modbus connection."""

from __future__ import annotations

from aff_runtime.base.ports import Clock, WordTransport
from aff_runtime.config.models import Channel, Site
from aff_runtime.fieldbus.catalogue import modbus_tcp
from aff_runtime.fieldbus.modbus_frames import WireFunction
from aff_runtime.fieldbus.registers import (
    Correction,
    Register,
    RegisterMap,
    WordOrder,
    WordType,
)


def register_map(site: Site) -> RegisterMap:
    """Return every word that is read and written; channels in the order of the site file."""
    gateway, read, write = site.gateway, site.gateway.read, site.gateway.write
    address = gateway.wire_address
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
        corrections=tuple(_correction(site, name) for name in site.actuators),
    )


def transport(site: Site, words: RegisterMap, clock: Clock) -> WordTransport:
    """Return the connection to the PLC; it connects by and by, within the ticks."""
    wire = site.gateway.modbus_tcp
    return modbus_tcp(
        host=wire.host,
        port=wire.port,
        device_id=wire.device_id,
        register_map=words,
        clock=clock,
        function=WireFunction(wire.function),
    )


def _channel(site: Site, name: str, channel: Channel) -> Register:
    """Return one measured value."""
    return Register(
        name=name,
        address=site.gateway.wire_address(channel.register_number),
        type=WordType(channel.type),
        scale=channel.scale,
        word_order=WordOrder(site.gateway.word_order),
        wraps=channel.wraps,
    )


def _correction(site: Site, actuator: str) -> Correction:
    """Return the correction word of one actuator and its complement."""
    correction = site.gateway.write.corrections[actuator]
    return Correction(
        register=Register(
            name=actuator,
            address=site.gateway.wire_address(correction.register_number),
            type=WordType(correction.type),
            scale=correction.scale,
        ),
        complement_address=site.gateway.wire_address(correction.complement),
    )
