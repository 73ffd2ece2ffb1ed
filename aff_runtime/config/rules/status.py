"""Status bits: each has a place of its own, and what is needed has one."""

from __future__ import annotations

from collections.abc import Iterator

from aff_runtime.config.findings import KeyPath
from aff_runtime.config.models import Site, StatusBit
from aff_runtime.config.rules.issue import Issue

_BITS: KeyPath = ("gateway", "read", "status", "bits")


def issues(site: Site) -> Iterator[Issue]:
    """Yield what is wrong with the places of the status bits."""
    bits = site.gateway.read.status.bits
    if bits is None:
        return
    if site.gateway.modbus is None:
        text = (
            "is for Modbus. On CAN the status signal has AFF's own order of bits; let the PLC "
            "send it so, and remove bits."
        )
        yield Issue(path=_BITS, text=text, at_key=True)
        return
    yield from _twice(site, bits.given)
    yield from _missing(site, bits.given)


def _twice(site: Site, given: dict[str, StatusBit]) -> Iterator[Issue]:
    own = site.gateway.read.status.register_number or 0
    taken: dict[tuple[int, int], str] = {}
    for name, place in given.items():
        register = own if place.register_number is None else place.register_number
        address = site.gateway.wire_address(register)
        other = taken.setdefault((address, place.bit), name)
        if other != name:
            text = f"bit {place.bit} of wire address {address} is {other} already. Move one."
            yield Issue(path=(*_BITS, name, "bit"), text=text)


def _missing(site: Site, given: dict[str, StatusBit]) -> Iterator[Issue]:
    for index, name in enumerate(site.permissives.need):
        if name not in given:
            text = f"{name} has no place in gateway.read.status.bits, so it reads 0. Add it there."
            yield Issue(path=("permissives", "need", index), text=text)
    if site.permissives.enable_from_plc and "AFF_ENABLE_REQUEST" not in given:
        text = (
            "AFF_ENABLE_REQUEST has no place, so nothing would arm. Add it, or write "
            "enable_from_plc: false under permissives."
        )
        yield Issue(path=_BITS, text=text, at_key=True)
