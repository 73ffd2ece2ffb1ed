"""The PLC of a draft: how it is reached, what its found words read, what is polled."""

from __future__ import annotations

import statistics

from aff_runtime.app.setup.asking.draft import Draft, FoundWord
from aff_runtime.app.setup.words.decoding import values
from aff_runtime.app.setup.words.reading import Watched, WordBlock, WordReader
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.ports import Clock
from aff_runtime.base.units import read_number, read_scale
from aff_runtime.fieldbus.modbus.byte_stream import ByteStream
from aff_runtime.fieldbus.modbus.connections import tcp_wire
from aff_runtime.fieldbus.modbus.udp_wire import UdpWire

_ADVICE_BY_WIRE = {
    "modbus_rtu": "setup looks over Modbus TCP and UDP. On a serial line begin with "
    "config/euclid.yaml and its modbus_rtu section, and look with `aff-runtime probe-map`; or "
    "reach the PLC by TCP for setup, and exchange the section afterwards."
}


def reader_of(draft: Draft, clock: Clock) -> WordReader:
    """Return a reader of the draft's PLC; nothing is sent yet.

    Raises
    ------
    ConfigError : setup does not look over this wire; says what to do instead.
    WireError : the name of the host is not known.
    """
    answers = draft.answers
    kind, host, port = answers["wire"], answers["host"], int(answers["port"])
    if kind in _ADVICE_BY_WIRE:
        raise ConfigError(_ADVICE_BY_WIRE[kind])
    wire: ByteStream = tcp_wire(host, port) if kind == "modbus_tcp" else UdpWire(host, port)
    return WordReader(
        wire, device_id=int(answers["device_id"]), clock=clock, where=f"{host}:{port}"
    )


def instead_of(kind: str) -> str:
    """Return what to do on a wire that setup does not look over; empty for the others."""
    return _ADVICE_BY_WIRE.get(kind, "")


def readings_si(word: FoundWord, unit: str, seen: Watched) -> list[float]:
    """Return the readings of a found quantity while it was watched, SI."""
    scale = scale_of(word.scale, unit)
    return [scale * count for count in values(word.decoding, seen)]


def mean_si(word: FoundWord, unit: str, seen: Watched) -> float:
    """Return the mean of a found quantity while it was watched, SI."""
    return statistics.fmean(readings_si(word, unit, seen))


def scale_of(text: str, unit: str) -> float:
    """Return a scale as the site file writes it, as SI units per count."""
    try:
        return read_number(float(text), unit)
    except ValueError:
        return read_scale(text, unit)


def polled(draft: Draft) -> WordBlock:
    """Return the one block of words that AFF will read each tick."""
    addresses = draft.owners
    return WordBlock(start=min(addresses), count=max(addresses) - min(addresses) + 1)
