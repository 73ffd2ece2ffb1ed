"""What goes where on a bus with frames, for eyes: bits, byte order, sign, unit and role."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from aff_runtime.base.channel_units import unit_of_channel
from aff_runtime.base.units import plain
from aff_runtime.config.can_wire import can_map_of, network_of, wire_files
from aff_runtime.config.models import Site
from aff_runtime.fieldbus.can.layout import CanMap, Field, FrameLayout

_LEGEND = (
    "bits >> shift: of the frame read as one number; Intel: first byte lowest, Motorola: highest"
)


def can_lines(site: Site, folder: Path) -> Iterator[str]:
    """Yield every frame with its signals, then what CANopen nodes are told at start.

    Raises
    ------
    ConfigError
        A file of the wire cannot be used.
    """
    texts = wire_files(site, folder)
    frames = can_map_of(site, texts)
    roles = _roles(site, frames)
    reading = {field.frame for field in frames.read_fields}
    yield _LEGEND
    for layout in frames.frames:
        read = layout.name in reading
        way = "read " if read else "write"
        yield f"{way} 0x{layout.can_id:03X}  {layout.length} bytes  {layout.name}"
        beat = frames.plc_heartbeat if read else frames.aff_heartbeat
        yield from _frame_words(layout, beat)
        for field in (*frames.read_fields, *frames.write_fields):
            if field.frame == layout.name:
                page = "" if field.selector is None else f", page {field.selector}"
                yield _line(field, roles[str(field)] + page)
    yield f"{frames.plc_heartbeat.frame} closes a scan: the PLC sends it last"
    if site.gateway.canopen_402 is not None:
        for plan in network_of(site, texts).plans:
            yield f"node {plan.node_id} {plan.name}: {len(plan.writes)} objects set at start"
            for write in plan.writes:
                value = int.from_bytes(write.data, "little")
                back = "read back" if write.verify else "written"
                yield f"  0x{write.index:04X}:{write.subindex:02X} = 0x{value:X}  {back}"


def thousand(si_per_count: float, unit: str) -> str:
    """Return what 1000 counts are, in SI."""
    return f"1000 counts = {plain(1000 * si_per_count)} {unit}"


def _frame_words(layout: FrameLayout, beat: Field) -> Iterator[str]:
    """Yield what a frame carries beside values; its sender must fill it in too."""
    if layout.multiplexer is not None:
        yield _line(layout.multiplexer, "says which page this frame carries")
    if layout.counter is not None:
        yield _line(layout.counter, f"repeats the low bits of {beat}")


def _roles(site: Site, frames: CanMap) -> dict[str, str]:
    """Return what every field means, by its name."""
    words = {
        "plc_heartbeat": frames.plc_heartbeat,
        "status": frames.status,
        "roll_id": frames.roll_id,
        "aff_echo": frames.aff_echo,
        "aff_heartbeat": frames.aff_heartbeat,
        "state": frames.state,
        "echo": frames.echo,
        "alarm": frames.alarm,
        "limit": frames.limit,
        "config_revision": frames.config_revision,
    }
    roles = {str(field): name for name, field in words.items() if field is not None}
    for channel in frames.channels:
        shown = _si(channel.field, channel.scale, unit_of_channel(channel.name) or "")
        extra = ", for the record alone" if channel.name in frames.recorded_only else ""
        roles[str(channel.field)] = f"{channel.name}, {shown}{extra}"
    for name, applied in zip(site.actuators, frames.applied, strict=False):
        if applied is not None:
            shown = _si(applied.field, applied.scale, site.actuators[name].unit)
            roles[str(applied.field)] = f"correction of {name} as applied, {shown}"
    for correction in frames.corrections:
        shown = _si(correction.field, correction.scale, site.actuators[correction.name].unit)
        roles[str(correction.field)] = f"correction of {correction.name}, {shown}"
        if correction.complement is not None:
            roles[str(correction.complement)] = f"ones complement of {correction.field.name}"
    return roles


def _si(field: Field, scale: float, unit: str) -> str:
    text = thousand(field.factor * scale, unit)
    return f"{text}, 0 = {plain(field.offset * scale)} {unit}" if field.offset else text


def _line(field: Field, role: str) -> str:
    order = "Motorola" if field.big_endian else "Intel"
    kind = "float" if field.is_float else "signed" if field.signed else "unsigned"
    bits = f"  {field.length:2} bits >> {field.shift:2}  {order:8} {kind:8}"
    return f"{bits}  {field.name:24} {role}"
