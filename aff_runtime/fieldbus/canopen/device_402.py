"""EDS files and object names to PDO frames and the configuration of every node (CiA 301, 402).

The canopen package reads the EDS; the tick itself only packs bytes.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import dataclass, field

from canopen.objectdictionary import ObjectDictionary, ODVariable

from aff_runtime.base.errors import ConfigError
from aff_runtime.fieldbus.can.layout import (
    CanChannel,
    CanCorrection,
    CanMap,
    Field,
    FrameLayout,
    applied_readings,
)
from aff_runtime.fieldbus.can.named_signal import NamedSignal
from aff_runtime.fieldbus.canopen.eds_file import load_eds
from aff_runtime.fieldbus.canopen.node import NodePlan, SdoWrite
from aff_runtime.fieldbus.signal_names import NamedError, SignalNames

# What canopen would print on the terminal is said here, with the file and what to do.
logging.getLogger("canopen").addHandler(logging.NullHandler())

_SIGNED = {0x02, 0x03, 0x04, 0x15}
_FLOAT = {0x08, 0x11}
_NOT_VALID = 1 << 31
_SYNCHRONOUS = 1
_BOOLEAN = 0x01
_OF_PDOS = ((0x181, 0x57F), (0x680, 0x6DF))  # CiA 301 keeps the other identifiers for itself
_SIZES = {0x01: 1, 0x02: 1, 0x03: 2, 0x04: 4, 0x05: 1, 0x06: 2, 0x07: 4, 0x08: 4}


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeSite:
    """One node as the site file describes it; ``writes``: ``0xIIII[:SS]`` to value."""

    node_id: int
    eds: str
    writes: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class Network:
    """Frames of the process data and what every node is to be told."""

    can_map: CanMap
    plans: tuple[NodePlan, ...]


@dataclass(slots=True)
class _Pdo:
    """One PDO of an EDS: its records, its identifier and where each object sits."""

    com_index: int
    map_index: int
    can_id: int
    entries: tuple[int, ...]
    timer: bool


def network(
    names: SignalNames,
    nodes: Mapping[str, NodeSite],
    eds_texts: Mapping[str, str],
    *,
    own_node: int,
    node_heartbeat_ms: int,
    lost_after_ms: int,
) -> Network:
    """Return frames and configuration for the signals ``NODE.0xIIII[:SS]`` of ``names``.

    What is read comes from TPDOs, what is written goes to RPDOs, as the EDS maps them. Each used
    PDO is switched off, made synchronous, mapped and switched on again; RPDOs get a deadline
    where the EDS has an event timer. Every node consumes our heartbeat within ``lost_after_ms``.

    Raises
    ------
    ConfigError
        An EDS cannot be read, or an object is not mapped in any PDO of its node.
    """
    builder = _Builder(nodes, eds_texts)
    read, write = builder.transmitted, builder.received
    can_map = CanMap(
        plc_heartbeat=read(names.plc_heartbeat),
        status=read(names.status),
        roll_id=read(names.roll_id),
        aff_echo=read(names.aff_echo) if names.aff_echo else None,
        applied=applied_readings(names, read),
        recorded_only=names.recorded_only,
        channels=tuple(
            CanChannel(name=name, field=read(signal), scale=scale, wraps=wraps)
            for name, (signal, scale, wraps) in names.channels.items()
        ),
        aff_heartbeat=write(names.aff_heartbeat),
        state=write(names.state),
        corrections=tuple(
            CanCorrection(
                name=name,
                field=write(signal),
                complement=write(copy) if copy else None,
                scale=scale,
            )
            for name, (signal, copy, scale) in names.corrections.items()
        ),
        echo=write(names.echo) if names.echo else None,
        alarm=write(names.alarm) if names.alarm else None,
        limit=write(names.limit) if names.limit else None,
        config_revision=write(names.config_revision) if names.config_revision else None,
        frames=builder.frames(),
    )
    plans = tuple(
        NodePlan(
            name=name,
            node_id=site.node_id,
            heartbeat_ms=node_heartbeat_ms,
            writes=builder.writes(name, own_node, node_heartbeat_ms, lost_after_ms),
        )
        for name, site in nodes.items()
    )
    return Network(can_map=can_map, plans=plans)


class _Builder:
    """Finds objects in PDOs and remembers which PDOs are used."""

    def __init__(self, nodes: Mapping[str, NodeSite], eds_texts: Mapping[str, str]) -> None:
        self._nodes = nodes
        self._ods = {
            name: load_eds(eds_texts[site.eds], site.eds, site.node_id)
            for name, site in nodes.items()
        }
        self._pdos: dict[tuple[str, bool], list[_Pdo]] = {}
        for name, od in self._ods.items():
            self._pdos[(name, True)] = _pdos(od, 0x1800, 0x1A00)
            self._pdos[(name, False)] = _pdos(od, 0x1400, 0x1600)
        self._used: dict[tuple[str, int], _Pdo] = {}

    def transmitted(self, signal: str) -> Field:
        """Return where a node's TPDO carries ``signal``."""
        return self._find(signal, transmit=True)

    def received(self, signal: str) -> Field:
        """Return where a node's RPDO takes ``signal``."""
        return self._find(signal, transmit=False)

    def frames(self) -> tuple[FrameLayout, ...]:
        """Return the PDOs found so far, by identifier."""
        used = sorted(self._used.items(), key=lambda item: item[1].can_id)
        return tuple(
            FrameLayout(
                name=_frame_name(name, pdo),
                can_id=pdo.can_id,
                extended=False,
                length=-(-sum(entry & 0xFF for entry in pdo.entries) // 8),
            )
            for (name, _), pdo in used
        )

    def writes(
        self, name: str, own_node: int, heartbeat_ms: int, lost_ms: int
    ) -> tuple[SdoWrite, ...]:
        """Return the configuration of one node, in the order the standard asks for."""
        od, site = self._ods[name], self._nodes[name]
        steps = [_write(od, 0x1016, 1, own_node << 16 | lost_ms)]
        steps.append(_write(od, 0x1017, 0, heartbeat_ms))
        for (owner, com_index), pdo in self._used.items():
            if owner != name:
                continue
            steps.append(_write(od, com_index, 1, pdo.can_id | _NOT_VALID, verify=False))
            steps.append(_write(od, com_index, 2, _SYNCHRONOUS))
            if pdo.timer:
                steps.append(_write(od, com_index, 5, lost_ms))
            steps.append(_write(od, pdo.map_index, 0, 0, verify=False))
            for position, entry in enumerate(pdo.entries, start=1):
                steps.append(_write(od, pdo.map_index, position, entry))
            steps.append(_write(od, pdo.map_index, 0, len(pdo.entries)))
            steps.append(_write(od, com_index, 1, pdo.can_id))
        for place, value in site.writes.items():
            index, subindex = object_of(place)
            try:
                steps.append(_write(od, index, subindex, value))
            except ConfigError as error:
                text = f"{error} {site.eds}. Compare with the manual of node {name}"
                raise NamedError(place, text) from None
        return tuple(steps)

    def _find(self, signal: str, *, transmit: bool) -> Field:
        name, _, place = signal.partition(".")
        if name not in self._ods:
            raise NamedError(signal, f"no node {name}; the nodes are {', '.join(self._ods)}")
        index, subindex = object_of(place)
        for pdo in self._pdos[(name, transmit)]:
            shift = 0
            for entry in pdo.entries:
                if entry >> 8 == index << 8 | subindex:
                    self._used[(name, pdo.com_index)] = pdo
                    try:
                        kind = _variable(self._ods[name], index, subindex).data_type
                    except ConfigError:
                        eds = self._nodes[name].eds
                        text = f"a PDO of {eds} maps this object, but the EDS does not describe it"
                        raise NamedError(signal, text) from None
                    _check_entry(signal, pdo, kind, entry & 0xFF)
                    return Field(
                        name=place,
                        frame=_frame_name(name, pdo),
                        shift=shift,
                        length=entry & 0xFF,
                        signed=kind in _SIGNED,
                        is_float=kind in _FLOAT,
                    )
                shift += entry & 0xFF
        word = "TPDO" if transmit else "RPDO"
        mapped = ", ".join(
            f"0x{entry >> 16:04X}" + (f":{entry >> 8 & 0xFF:02X}" if entry >> 8 & 0xFF else "")
            for pdo in self._pdos[(name, transmit)]
            for entry in pdo.entries
        )
        text = (
            f"no {word} of {self._nodes[name].eds} maps this object; mapped are {mapped or 'none'}"
        )
        raise NamedError(signal, text)


def mapped_signals(od: ObjectDictionary, node: str) -> tuple[NamedSignal, ...]:
    """Return every object that a PDO of an EDS maps, as a site names it on node ``node``.

    Objects that the EDS does not describe, and those that are mapped in part, are left out, as no
    site file may name them.
    """
    found = []
    for pdo in (*_pdos(od, 0x1800, 0x1A00), *_pdos(od, 0x1400, 0x1600)):
        frame = _frame_name(node, pdo)
        length = -(-sum(entry & 0xFF for entry in pdo.entries) // 8)
        shift = 0
        for entry in pdo.entries:
            index, subindex, bits = entry >> 16, entry >> 8 & 0xFF, entry & 0xFF
            place = f"0x{index:04X}" + (f":{subindex:02X}" if subindex else "")
            try:
                described = _variable(od, index, subindex)
                kind = described.data_type
                _check_entry(place, pdo, kind, bits)
                field = Field(
                    name=place,
                    frame=frame,
                    shift=shift,
                    length=bits,
                    signed=kind in _SIGNED,
                    is_float=kind in _FLOAT,
                )
                layout = FrameLayout(name=frame, can_id=pdo.can_id, extended=False, length=length)
            except ConfigError:
                continue
            finally:
                shift += bits
            found.append(
                NamedSignal(
                    name=f"{node}.{place}",
                    field=field,
                    layout=layout,
                    called=described.name,
                    owner=node,
                    sent_to_us=pdo.com_index >= 0x1800,
                )
            )
    return tuple(found)


def _check_entry(signal: str, pdo: _Pdo, kind: int | None, bits: int) -> None:
    """Refuse a PDO on an identifier of another service, and an object that is mapped in part."""
    if not any(first <= pdo.can_id <= last for first, last in _OF_PDOS):
        text = f"its PDO has the identifier 0x{pdo.can_id:X}; a PDO's is 0x181 to 0x57F"
        raise NamedError(signal, text)
    size = 8 * _SIZES.get(kind or 0, 0)
    if size and kind != _BOOLEAN and bits != size:
        raise NamedError(signal, f"{bits} bits of it are mapped, but it has {size}")


def object_of(place: str) -> tuple[int, int]:
    """Return index and subindex of ``0xIIII`` or ``0xIIII:SS``.

    Raises
    ------
    ConfigError
        It is neither.
    """
    index, _, subindex = place.partition(":")
    try:
        found = int(index, 16), int(subindex or "0", 16)
    except ValueError:
        found = (-1, -1)
    if not 0x1000 <= found[0] <= 0xFFFF or not 0 <= found[1] <= 0xFF:
        raise ConfigError(f"{place!r}: write an object as 0x60B1 or 0x1016:01")
    return found


def _pdos(od: ObjectDictionary, com: int, mapping: int) -> list[_Pdo]:
    found = []
    for number in range(0x200):
        if com + number not in od or mapping + number not in od:
            continue
        record, entries = od[com + number], od[mapping + number]
        if isinstance(record, ODVariable) or isinstance(entries, ODVariable):
            continue
        count = _default(od, mapping + number, 0)
        values = tuple(_default(od, mapping + number, i + 1) for i in range(count))
        can_id = _default(od, com + number, 1)
        if can_id & _NOT_VALID or not values:
            continue
        cob_id = can_id & 0x3FFF_FFFF  # with the bit of 29-bit identifiers, which nobody reads
        found.append(_Pdo(com + number, mapping + number, cob_id, values, 5 in record))
    return found


def _default(od: ObjectDictionary, index: int, subindex: int) -> int:
    value = _variable(od, index, subindex).default
    if value is not None and not isinstance(value, int):
        raise ConfigError(f"0x{index:04X}:{subindex:02X} is {value!r} in the EDS, not a number")
    return value or 0


def _variable(od: ObjectDictionary, index: int, subindex: int) -> ODVariable:
    try:
        found = od.get_variable(index, subindex)
    except KeyError:
        found = None
    if found is None:
        raise ConfigError(f"0x{index:04X}:{subindex:02X} is not in the EDS")
    return found


def _write(
    od: ObjectDictionary, index: int, subindex: int, value: int, *, verify: bool = True
) -> SdoWrite:
    kind = _variable(od, index, subindex).data_type
    size = _SIZES.get(kind or 0)
    if size is None:
        raise ConfigError(f"0x{index:04X}:{subindex:02X} is no number of up to four bytes")
    try:
        data = value.to_bytes(size, "little", signed=value < 0)
    except OverflowError:
        raise ConfigError(f"0x{index:04X}:{subindex:02X} cannot hold {value}") from None
    return SdoWrite(index=index, subindex=subindex, data=data, verify=verify)


def _frame_name(name: str, pdo: _Pdo) -> str:
    word = "TPDO" if pdo.com_index >= 0x1800 else "RPDO"
    return f"{name}.{word}{(pdo.com_index & 0x1FF) + 1}"
