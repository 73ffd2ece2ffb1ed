"""Site file to register map."""

from __future__ import annotations

from collections.abc import Callable

from aff_runtime.base.signals import Status
from aff_runtime.config.models import Channel, Site
from aff_runtime.fieldbus.modbus.registers import (
    Correction,
    Register,
    RegisterMap,
    StatusPlace,
    WordOrder,
    WordType,
)


def register_map(site: Site) -> RegisterMap:
    """Return every word that is read and written; channels in the order of the site file."""
    read, write = site.gateway.read, site.gateway.write
    address, aff_echo, applied = _address(site), read.aff_echo, site.gateway.applied
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
        applied=tuple(_applied(site, name) for name in site.actuators) if applied else (),
        status_places=_status_places(site),
    )


def _status_places(site: Site) -> tuple[StatusPlace, ...]:
    """Return where each status bit stands; none when the status word is in our own order."""
    status, address = site.gateway.read.status, _address(site)
    if status.bits is None:
        return ()
    return tuple(
        StatusPlace(
            means=Status[name],
            address=address(
                status.register_number if place.register_number is None else place.register_number
            ),
            bit=place.bit,
            inverted=place.inverted,
        )
        for name, place in status.bits.given.items()
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
        wraps_after=channel.wraps_after or 0,
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


def _applied(site: Site, actuator: str) -> Register | None:
    """Return the word in which the PLC shows what it applies of a correction, if there is one."""
    shown = site.gateway.applied.get(actuator)
    if shown is None:
        return None
    return Register(
        name=actuator,
        address=_address(site)(shown.register_number),
        type=WordType(shown.type),
        scale=shown.scale,
    )


def _address(site: Site) -> Callable[[int | None], int]:
    """Return how a register number becomes a wire address; rules see that it is given."""
    return lambda register: site.gateway.wire_address(register or 0)
