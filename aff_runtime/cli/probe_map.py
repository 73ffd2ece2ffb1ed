"""``aff-runtime probe-map SITE.yaml``: look at the PLC's words, write none."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from aff_runtime.app.wiring.site_to_wire import register_map
from aff_runtime.app.wiring.wires import wire_of
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.effort import bounded_effort
from aff_runtime.base.errors import ConfigError, WireError
from aff_runtime.cli.service import add_state_dir
from aff_runtime.cli.terminal import say
from aff_runtime.config.can_wire import can_map_of, wire_files
from aff_runtime.config.loader import load_site
from aff_runtime.config.models import ModbusRtu, Site
from aff_runtime.fieldbus.modbus.codec import WordCodec
from aff_runtime.fieldbus.modbus.probe_map import MapProbe, open_read_only
from aff_runtime.fieldbus.modbus.probe_map import probe_map as look
from aff_runtime.fieldbus.modbus.serial_time import transaction_ms

PERIOD_S = 0.02


def add(commands: Any, service: argparse.ArgumentParser) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "probe-map", help="read the PLC's block: values, and every word order; writes nothing"
    )
    parser.add_argument("site", type=Path, metavar="SITE.yaml")
    add_state_dir(parser)
    parser.set_defaults(command=probe_map)


def probe_map(options: argparse.Namespace) -> int:
    """Read the block a few times and print every reading of every word."""
    with bounded_effort(str(options.site), ConfigError):
        site = load_site(options.site, options.state_dir)
    clock = MonotonicClock()
    modbus = site.gateway.modbus
    if modbus is None:
        return probe_frames(site, options.site, clock)
    words = register_map(site)
    transport = open_read_only(
        device_id=modbus.device_id,
        read_start=words.read_start,
        read_count=words.read_count,
        clock=clock,
        wire=wire_of(site, options.site.absolute().parent),
    )
    rtu = site.gateway.modbus_rtu
    try:
        seen = look(
            transport,
            clock,
            read_start=words.read_start,
            heartbeat_address=words.plc_heartbeat,
            period_s=PERIOD_S if rtu is None else serial_period_s(rtu, words.read_count),
        )
    except WireError as error:
        raise WireError(f"gateway: {transport.trouble or error}") from error
    finally:
        transport.close()
    for line in table(site, seen):
        say(line)
    return 0


def serial_period_s(rtu: ModbusRtu, words: int) -> float:
    """Return a period in which the line carries a reading twice, s."""
    return max(PERIOD_S, 2e-3 * transaction_ms(words, 0, rtu.baud, fc23=False))


def probe_frames(site: Site, path: Path, clock: MonotonicClock) -> int:
    """Listen to the bus for two seconds and print every frame that the map reads."""
    from aff_runtime.fieldbus.probe_frames import listen  # noqa: PLC0415 (needs the can extra)

    can = site.gateway.can
    if can is None:
        return 2
    frames = can_map_of(site, wire_files(site, path.absolute().parent))
    for line in listen(frames, can.interface, can.channel, can.bitrate, clock):
        say(line)
    return 0


def table(site: Site, seen: MapProbe) -> Iterator[str]:
    """Yield the words as text, and each channel's value as the site file reads it."""
    moves = "moves" if seen.heartbeat_moves else "STANDS STILL: wrong register or a stopped PLC"
    yield f"{seen.samples} replies, {seen.failures} failures; plc_heartbeat {moves}"
    words = register_map(site)
    owners = {words.plc_heartbeat: "plc_heartbeat", words.status: "status"}
    owners[words.roll_id] = "roll_id"
    if words.aff_echo is not None:
        owners[words.aff_echo] = "aff_echo"
    codec, block = WordCodec(words), [word.u16 for word in seen.words]
    values = codec.decode(block)[3]
    for register, value in zip(words.applied, codec.applied(block), strict=True):
        if register is not None:
            owners[register.address] = f"applied.{register.name} = {value:.6g}"
    owners |= {
        channel.address: f"{channel.name} = {value:.6g}"
        for channel, value in zip(words.channels, values, strict=True)
    }
    for word in seen.words:
        name = owners.get(word.address, "")
        readings = f"u16 {word.u16:5}  i16 {word.i16:6}  moves {word.changes:3}"
        yield f"wire {word.address:5}  {readings}  {name}".rstrip()
        for double in word.decodings if name else ():
            readings = f"i32 {double.i32:11}  u32 {double.u32:10}  f32 {double.f32:.6g}"
            yield f"      {double.order:26} {readings}"
