"""The wire: exactly one way to the PLC, and every value has a place on it."""

from __future__ import annotations

from collections.abc import Iterator

from aff_runtime.config.findings import KeyPath
from aff_runtime.config.models import Applied, Channel, Correction, ReadWord, Site, WriteWord
from aff_runtime.config.models.gateway import WIRES
from aff_runtime.config.rules.issue import Issue

PLAIN = (
    "nothing on this wire is encrypted or signed: who can reach the PLC can do what this service "
    "can do, up to the PLC's own limit. Keep others off this network; Modbus TCP may have tls."
)
_Place = ReadWord | WriteWord | Channel | Correction | Applied


def issues(site: Site) -> Iterator[Issue]:
    """Yield what is wrong with the choice of the wire and the places on it."""
    given = [name for name in WIRES if getattr(site.gateway, name) is not None]
    if len(given) != 1:
        said = " and ".join(given) or "none"
        text = f"give exactly one of {', '.join(WIRES)}; given: {said}."
        yield Issue(path=("gateway",), text=text, at_key=True)
        return
    is_modbus = site.gateway.modbus is not None
    for name in ("address_base", "word_order"):
        if is_modbus and getattr(site.gateway, name) is None:
            wanted = type(site.gateway).model_fields[name].description
            yield Issue(
                path=("gateway", name), text=f"required key is missing. {wanted}", at_key=True
            )
    for path, place in places(site):
        lack = _missing(place, is_modbus)
        if lack:
            text = f"{lack} is missing; {given[0]} needs it."
            yield Issue(path=path, text=text, at_key=True)
    if site.gateway.modbus_tcp is None or site.gateway.modbus_tcp.tls is None:
        yield Issue(path=("gateway", given[0]), text=PLAIN, warning=True, at_key=True)
    if is_modbus and site.gateway.read.aff_echo is None:  # on a bus everybody's frames are seen
        text = (
            "no aff_echo: a second master that always writes last before the PLC's scan cannot "
            "be seen, and both say ACTIVE. Let the PLC copy aff_heartbeat to a word that is read."
        )
        yield Issue(path=("gateway", "read"), text=text, warning=True, at_key=True)
    if site.gateway.applied and site.gateway.read.aff_echo is None:
        text = (
            "needs aff_echo: by it AFF knows which of its commands the applied correction is to "
            "be compared with. Map aff_echo, or leave applied out."
        )
        yield Issue(path=("gateway", "read", "applied"), text=text, at_key=True)


def _missing(place: _Place, is_modbus: bool) -> str:
    """Return which key a value lacks on this kind of wire; empty for none."""
    if not is_modbus:
        return "signal" if place.signal is None else ""
    if place.register_number is None:
        return "register"
    if isinstance(place, Channel) and place.type is None:
        return "type"
    if isinstance(place, Correction) and place.complement is None:
        return "complement"
    return ""


def places(site: Site) -> Iterator[tuple[KeyPath, _Place]]:
    """Yield every value on the wire with its path."""
    read, write = site.gateway.read, site.gateway.write
    words: tuple[tuple[KeyPath, _Place], ...] = (
        (("gateway", "read", "plc_heartbeat"), read.plc_heartbeat),
        (("gateway", "read", "status"), read.status),
        (("gateway", "read", "roll_id"), read.roll_id),
        (("gateway", "write", "aff_heartbeat"), write.aff_heartbeat),
        (("gateway", "write", "state"), write.state),
        (("gateway", "write", "echo"), write.echo),
        (("gateway", "write", "alarm"), write.alarm),
        (("gateway", "write", "limit"), write.limit),
        (("gateway", "write", "config_revision"), write.config_revision),
    )
    yield from words
    if read.aff_echo is not None:
        yield ("gateway", "read", "aff_echo"), read.aff_echo
    for name, channel in read.channels.items():
        yield ("gateway", "read", "channels", name), channel
    for name, correction in write.corrections.items():
        yield ("gateway", "write", "corrections", name), correction
    for name, applied in site.gateway.applied.items():
        yield ("gateway", "read", "applied", name), applied
