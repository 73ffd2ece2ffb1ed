"""A site on CAN: its signals as names, its files, and what the files must agree with."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from aff_runtime.base.channel_units import suffix_of_unit
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.units import plain
from aff_runtime.config.findings import KeyPath
from aff_runtime.config.models import Actuator, Site
from aff_runtime.config.plain_file import TooLargeError, read_plain
from aff_runtime.config.rules.issue import Issue
from aff_runtime.fieldbus.can.load import MOST_SHARE, bus_share
from aff_runtime.fieldbus.signal_names import NamedError, SignalNames, WireFileError

if TYPE_CHECKING:
    from aff_runtime.fieldbus.can.layout import CanChannel, CanCorrection, CanMap
    from aff_runtime.fieldbus.canopen.device_402 import Network

_SAME = 1e-9


def signal_names(site: Site) -> SignalNames:
    """Return which signal means what; empty where the site gives none."""
    read, write = site.gateway.read, site.gateway.write
    shown = site.gateway.applied
    counts = site.gateway.canopen_402 is not None  # an EDS knows no scale, a DBC file does
    return SignalNames(
        plc_heartbeat=read.plc_heartbeat.signal or "",
        status=read.status.signal or "",
        roll_id=read.roll_id.signal or "",
        aff_echo=(read.aff_echo.signal or "") if read.aff_echo is not None else "",
        applied={n: (a.signal or "", a.scale if counts else 1.0) for n, a in shown.items()},
        channels={n: (c.signal or "", c.scale, c.wraps) for n, c in read.channels.items()},
        recorded_only=site.recorded_only,
        aff_heartbeat=write.aff_heartbeat.signal or "",
        state=write.state.signal or "",
        echo=write.echo.signal or "",
        alarm=write.alarm.signal or "",
        limit=write.limit.signal or "",
        config_revision=write.config_revision.signal or "",
        corrections={
            name: (c.signal or "", c.complement_signal or "", c.scale if counts else 1.0)
            for name, c in ((name, write.corrections[name]) for name in site.actuators)
        },
    )


def wire_files(site: Site, folder: Path) -> dict[str, str]:
    """Return the texts of the files that describe the wire, by the name the site gives them.

    Raises
    ------
    ConfigError
        A file cannot be read.
    """
    wanted = [site.gateway.can_dbc.dbc] if site.gateway.can_dbc is not None else []
    if site.gateway.canopen_402 is not None:
        wanted += [node.eds for node in site.gateway.canopen_402.nodes.values()]
    return {name: wire_text(folder, name) for name in wanted}


def wire_text(folder: Path, name: str) -> str:
    """Return the text of one file that describes a wire; ``name`` counts from ``folder``.

    Raises
    ------
    ConfigError
        It cannot be read.
    """
    try:
        return _text(read_plain(folder / name))
    except OSError as error:
        text = (
            f"cannot be read ({error.strerror}). Looked for {folder / name}: "
            "correct the name or put the file there"
        )
        raise NamedError(name, text) from None
    except TooLargeError as error:
        text = f"{folder / name} {error}. Leave in it what this line needs"
        raise NamedError(name, text) from None
    except ValueError as error:
        raise NamedError(name, f"{folder / name} {error}. Correct the name") from None


def _text(content: bytes) -> str:
    """Return the text of a DBC or EDS file; Windows tools often write its code page."""
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("latin-1")


def can_map_of(site: Site, texts: dict[str, str]) -> CanMap:
    """Return the frames of a site on CAN; only this needs the ``can`` extra.

    Raises
    ------
    ConfigError
        A file cannot be used, a signal does not exist, or the extra is not installed.
    """
    try:
        from aff_runtime.fieldbus.can.dbc import can_map, load_dbc  # noqa: PLC0415 (extra)
    except ImportError as error:
        raise ConfigError(
            f"CAN needs the extra: pip install 'aff-runtime[can]' ({error})"
        ) from None
    can = site.gateway.can_dbc
    if can is None:
        return network_of(site, texts).can_map
    return can_map(load_dbc(texts[can.dbc], can.dbc), signal_names(site))


def counter_ranges_rad(site: Site, texts: dict[str, str]) -> dict[str, float]:
    """Return after how much the counter of an angle starts over, rad, by channel.

    Empty on Modbus, where the site file's own types say it.

    Raises
    ------
    ConfigError
        As `can_map_of`.
    """
    if site.gateway.can is None:
        return {}
    channels = can_map_of(site, texts).channels
    ranges = {c.name: c.modulus * abs(c.field.factor * c.scale) for c in channels}
    return {name: range_rad for name, range_rad in ranges.items() if range_rad}


def network_of(site: Site, texts: dict[str, str]) -> Network:
    """Return frames and configuration of a site on CANopen.

    Raises
    ------
    ConfigError
        As `can_map_of`.
    """
    from aff_runtime.fieldbus.canopen.device_402 import NodeSite, network, object_of  # noqa: PLC0415

    section = site.gateway.canopen_402
    if section is None:
        raise ConfigError("gateway: no CAN section")
    nodes = {
        name: NodeSite(
            node_id=node.node, eds=node.eds, writes={o.object: o.value for o in node.objects}
        )
        for name, node in section.nodes.items()
    }
    for place in (entry for node in nodes.values() for entry in node.writes):
        object_of(place)
    return network(
        signal_names(site),
        nodes,
        texts,
        own_node=section.own_node,
        node_heartbeat_ms=section.node_heartbeat_ms,
        lost_after_ms=section.lost_after_ms,
    )


def issues(site: Site, folder: Path) -> Iterator[Issue]:
    """Yield what is wrong between the site file and the files of its wire."""
    can = site.gateway.can
    if can is None:
        return
    section = ("gateway", site.gateway.wire)
    node_issues = list(_node_issues(site))
    if node_issues:
        yield from node_issues
        return
    try:
        frames = can_map_of(site, wire_files(site, folder))
    except ConfigError as error:
        key = "dbc" if site.gateway.can_dbc is not None else "nodes"
        named = error.named if isinstance(error, NamedError) else ""
        path = _where(site.gateway.model_dump(), named, ("gateway",))
        text = error.in_folder(folder) if isinstance(error, WireFileError) else str(error)
        yield Issue(path=path or (*section, key), text=text)
        return
    for correction in frames.corrections:
        path = ("gateway", "write", "corrections", correction.name)
        yield from _scale(path, site.gateway.write.corrections[correction.name].scale, correction)
        yield from _room(site.actuators[correction.name], correction)
    for name, shown in zip(site.actuators, frames.applied, strict=False):
        if shown is not None:
            yield from _shown(site.actuators[name], site.gateway.applied[name].scale, name, shown)
    yield from _untold(site)
    share = load_share(site, frames)
    if share > MOST_SHARE:
        text = (
            f"the cyclic frames take {share:.0%} of {can.bitrate} bit/s each "
            f"{site.line.cycle_ms:g} ms (worst-case stuffing); at most {MOST_SHARE:.0%}. "
            "Raise bitrate or cycle_ms."
        )
        yield Issue(path=(*section, "bitrate"), text=text)


def _scale(path: KeyPath, stated: float, shown: CanCorrection | CanChannel) -> Iterator[Issue]:
    """Yield an issue where a stated scale is not what one count of the signal is."""
    factor = abs(shown.field.factor * shown.scale)
    if abs(stated - factor) > _SAME * factor:
        text = f"{shown.field} has {plain(factor)} per count. Write that."
        yield Issue(path=(*path, "scale"), text=text)


def _shown(actuator: Actuator, stated: float, name: str, shown: CanChannel) -> Iterator[Issue]:
    """Yield an issue where an applied correction cannot be read as it is."""
    path, field = ("gateway", "read", "applied", name), shown.field
    yield from _scale(path, stated, shown)
    ends = [count * field.factor + field.offset for count in field.count_range]
    ends = [
        max(min(ends), field.minimum) * shown.scale,
        min(max(ends), field.maximum) * shown.scale,
    ]
    if actuator.limit > min(-min(ends), max(ends)) * (1 + _SAME):
        text = (
            f"{field} carries {plain(min(ends))} to {plain(max(ends))} {actuator.unit}, less than "
            f"the limit {plain(actuator.limit)} {actuator.unit}. Use a wider or coarser signal."
        )
        yield Issue(path=(*path, "signal"), text=text)


def _room(actuator: Actuator, correction: CanCorrection) -> Iterator[Issue]:
    """Yield an issue where the limit is beyond what the signal carries, or rest no count of 0."""
    field = correction.field
    if field.offset:
        rest = round(-field.offset / field.factor)
        text = (
            f"{field} has an offset: rest is sent as {rest} counts, "
            "and AFF_GATEWAY adds counts as they come. Take the offset out, or off in the PLC."
        )
        where = ("gateway", "write", "corrections", correction.name, "signal")
        yield Issue(path=where, text=text, warning=True)
    least, most = correction.reach
    room, unit = min(-least, most), actuator.unit
    if actuator.limit > room * (1 + _SAME):
        text = (
            f"{plain(actuator.limit)} {unit} does not fit {field}, which carries "
            f"{plain(least)} to {plain(most)} {unit} by bits, offset and range. "
            "Lower the limit, or widen the signal."
        )
        path = ("actuators", correction.name, f"limit_{suffix_of_unit(unit)}")
        yield Issue(path=path, text=text)


def _untold(site: Site) -> Iterator[Issue]:
    """Yield a warning for drives that take a correction and are told nothing for our loss."""
    section = site.gateway.canopen_402
    if section is None:
        return
    signals = [row.signal or "" for row in site.gateway.write.corrections.values()]
    drives = {signal.partition(".")[0] for signal in signals}
    for name, node in section.nodes.items():
        if name in drives and not node.objects:
            text = (
                "takes a correction, but its reaction to our lost heartbeat is neither set nor "
                'verified. Add objects: [{ object: "0x6007", value: ... }], or the maker\'s own.'
            )
            path = ("gateway", "canopen_402", "nodes", name)
            yield Issue(path=path, text=text, warning=True, at_key=True)


def _where(value: object, named: str, path: KeyPath) -> KeyPath | None:
    """Return the key path whose text is ``named``, the last of several; None without one."""
    if isinstance(value, str):
        return path if named and value == named else None
    inner: list[tuple[str | int, object]] = []
    if isinstance(value, dict):
        inner = list(value.items())
    elif isinstance(value, list | tuple):
        inner = list(enumerate(value))
    for key, one in reversed(inner):
        found = _where(one, named, (*path, key))
        if found is not None:
            return found
    return None


def load_share(site: Site, frames: CanMap) -> float:
    """Return the share of the bus that one cycle's frames take, worst case."""
    can = site.gateway.can
    used = [(frame.length, frame.extended) for frame in frames.frames]
    if site.gateway.canopen_402 is not None:
        used.append((0, False))  # SYNC
    return bus_share(used, can.bitrate if can is not None else 1, site.cycle_s)


def _node_issues(site: Site) -> Iterator[Issue]:
    section = site.gateway.canopen_402
    if section is None:
        return
    path = ("gateway", "canopen_402")
    cycle_ms = site.line.cycle_ms
    apart_ms = cycle_ms * math.ceil(section.heartbeat_ms / cycle_ms - _SAME)
    if section.lost_after_ms < 3 * apart_ms * (1 - _SAME):
        text = (
            f"{section.lost_after_ms} ms is under three heartbeats: heartbeat_ms "
            f"{section.heartbeat_ms} leave every {plain(apart_ms)} ms with the ticks of cycle_ms "
            f"{plain(cycle_ms)}. Write {math.ceil(3 * apart_ms * (1 - _SAME))} or more, or lower "
            "heartbeat_ms or cycle_ms."
        )
        yield Issue(path=(*path, "lost_after_ms"), text=text)
    taken: dict[int, str] = {section.own_node: "own_node"}
    for name, node in section.nodes.items():
        other = taken.setdefault(node.node, name)
        if other != name:
            text = f"node id {node.node} is taken by {other}. Give every node its own."
            yield Issue(path=(*path, "nodes", name, "node"), text=text)
