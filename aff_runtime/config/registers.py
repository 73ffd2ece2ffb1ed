"""The register map as rows: who stands on which wire address."""

from __future__ import annotations

from dataclasses import dataclass

from aff_runtime.config.findings import KeyPath
from aff_runtime.config.models import Site

MAX_READ_WORDS = 125
MAX_WRITE_WORDS = {"fc23": 121, "fc3_fc16": 123}
LAST_ADDRESS = 65535
_WORDS = {"u16": 1, "i16": 1, "u32": 2, "i32": 2}


@dataclass(frozen=True, slots=True, kw_only=True)
class RegisterSpan:
    """One value on the wire.

    Attributes
    ----------
    path : its key, up to and with ``register`` or ``complement``.
    address, words : first wire address, and how many words it takes (1 or 2).
    type : u16, i16, u32 or i32.
    """

    path: KeyPath
    address: int
    words: int
    type: str

    @property
    def last(self) -> int:
        """Return the last wire address it takes."""
        return self.address + self.words - 1


def read_rows(site: Site) -> list[RegisterSpan]:
    """Return every value that is read, by wire address; none unless on Modbus."""
    if site.gateway.modbus is None:
        return []
    read, base = site.gateway.read, ("gateway", "read")
    rows = [
        _row(site, (*base, name, "register"), word.register_number, word.type)
        for name, word in (
            ("plc_heartbeat", read.plc_heartbeat),
            ("status", read.status),
            ("roll_id", read.roll_id),
            ("aff_echo", read.aff_echo),
        )
        if word is not None
    ]
    rows += _bit_rows(site)
    for name, channel in read.channels.items():
        path = (*base, "channels", name, "register")
        rows.append(_row(site, path, channel.register_number, channel.type))
    for name, applied in site.gateway.applied.items():
        path = (*base, "applied", name, "register")
        rows.append(_row(site, path, applied.register_number, applied.type))
    return sorted(rows, key=lambda row: row.address)


def _bit_rows(site: Site) -> list[RegisterSpan]:
    """Return the words that hold status bits alone, each once."""
    status = site.gateway.read.status
    taken = {site.gateway.wire_address(status.register_number or 0)}
    rows = []
    for name, place in (status.bits.given if status.bits is not None else {}).items():
        if place.register_number is None:
            continue
        path = ("gateway", "read", "status", "bits", name, "register")
        row = _row(site, path, place.register_number, "u16")
        if row.address not in taken:
            taken.add(row.address)
            rows.append(row)
    return rows


def write_rows(site: Site) -> list[RegisterSpan]:
    """Return every word that is written, by wire address; none unless on Modbus."""
    if site.gateway.modbus is None:
        return []
    write, base = site.gateway.write, ("gateway", "write")
    rows = [
        _row(site, (*base, name, "register"), word.register_number, "u16")
        for name, word in (
            ("aff_heartbeat", write.aff_heartbeat),
            ("state", write.state),
            ("echo", write.echo),
            ("alarm", write.alarm),
            ("limit", write.limit),
            ("config_revision", write.config_revision),
        )
    ]
    for name, correction in write.corrections.items():
        path = (*base, "corrections", name)
        rows.append(_row(site, (*path, "register"), correction.register_number, "i16"))
        rows.append(_row(site, (*path, "complement"), correction.complement, "u16"))
    return sorted(rows, key=lambda row: row.address)


def _row(site: Site, path: KeyPath, register: int | None, type_name: str | None) -> RegisterSpan:
    address = site.gateway.wire_address(register or 0)
    shown = type_name or "u16"
    return RegisterSpan(path=path, address=address, words=_WORDS[shown], type=shown)


def block_of(rows: list[RegisterSpan]) -> tuple[int, int]:
    """Return the first wire address of a block and its number of words."""
    if not rows:
        return 0, 0
    first = min(row.address for row in rows)
    return first, max(row.last for row in rows) - first + 1
