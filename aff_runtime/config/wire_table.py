"""What goes where on the wire, as a table for eyes: address or frame, type, scale, an example."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from aff_runtime.base.channel_units import unit_of_channel
from aff_runtime.base.units import plain
from aff_runtime.config.can_table import can_lines, thousand
from aff_runtime.config.can_wire import can_map_of, load_share, wire_files
from aff_runtime.config.findings import dotted
from aff_runtime.config.models import Site
from aff_runtime.config.registers import block_of, read_rows, write_rows
from aff_runtime.fieldbus.modbus.serial_time import transaction_ms

_WIDTH = 36  # of "1000 counts = 1.53398078789 rad"


def wire_lines(site: Site, folder: Path) -> Iterator[str]:
    """Yield the table of a valid site, then what it costs on the bus.

    Raises
    ------
    ConfigError
        A file of the wire cannot be used.
    """
    yield from (
        _modbus_lines(site) if site.gateway.modbus is not None else can_lines(site, folder)
    )
    yield from budget_lines(site, folder)


def _modbus_lines(site: Site) -> Iterator[str]:
    modbus = site.gateway.modbus
    if modbus is None:
        return
    fc23 = modbus.function == "fc23"
    for title, rows in (("read", read_rows(site)), ("write", write_rows(site))):
        first, words = block_of(rows)
        function = "FC23" if fc23 else "FC3" if title == "read" else "FC16"
        yield f"{title}: {function}, wire {first}..{first + words - 1}, {words} words"
        for row in rows:
            name = dotted(row.path[2:])
            yield f"  wire {row.address:5}  {row.type}  {_example(site, row.path)}  {name}"


def budget_lines(site: Site, folder: Path) -> Iterator[str]:
    """Yield what one cycle costs on the bus: transactions and time, or the share of a CAN bus.

    Raises
    ------
    ConfigError
        A file of the wire cannot be used.
    """
    modbus, can = site.gateway.modbus, site.gateway.can
    cycle = plain(site.line.cycle_ms)
    if can is not None:
        share = load_share(site, can_map_of(site, wire_files(site, folder)))
        yield f"bus load {share:.1%} of {can.bitrate} bit/s each {cycle} ms"
    if modbus is None:
        return
    fc23 = modbus.function == "fc23"
    count = 1 if fc23 else 2
    yield f"{count} transaction(s) per tick of {cycle} ms"
    rtu = site.gateway.modbus_rtu
    if rtu is not None:
        words_both = block_of(read_rows(site))[1], block_of(write_rows(site))[1]
        needed_ms = transaction_ms(*words_both, rtu.baud, fc23=fc23)
        yield f"{needed_ms:.2f} ms on the line at {rtu.baud} bit/s"


def _example(site: Site, path: tuple[str | int, ...]) -> str:
    """Return what 1000 counts are, for values with a scale."""
    name = str(path[-2])
    said = ""
    if "channels" in path:
        said = thousand(site.gateway.read.channels[name].scale, unit_of_channel(name) or "")
    elif "applied" in path:
        said = thousand(site.gateway.applied[name].scale, site.actuators[name].unit)
    elif "corrections" in path and path[-1] == "register":
        said = thousand(site.gateway.write.corrections[name].scale, site.actuators[name].unit)
    return said.ljust(_WIDTH)
