"""Reads the PLC's register map from YAML."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError, field_validator

from aff_runtime.base.errors import PlantError
from aff_runtime.base.signals import Status
from sim_plant.line.yaml_file import load_yaml
from sim_plant.servers.plc_map import CorrectionItem, PlcMap, StatusBit
from sim_plant.servers.words import RegisterItem, WordType

_READ_WORDS = ("plc_heartbeat", "status", "roll_id")
_WRITE_WORDS = ("aff_heartbeat", "state", "echo", "alarm", "limit", "config_revision")
_MAX_READ = 125
_MAX_WRITE = 121


def _not_zero(scale: float) -> float:
    if not (scale and math.isfinite(scale)):
        raise ValueError("write the SI units in one count; below 0 where it counts the other way")
    return scale


def _only_status(names: Sequence[object]) -> None:
    unknown = [name for name in names if name not in Status.__members__]
    if unknown:
        raise ValueError(f"unknown {unknown}; known are {list(Status.__members__)}")


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


_Address = Annotated[int, Field(ge=0, le=65536)]
_Scale = Annotated[float, Field(gt=0.0)]
_SignedScale = Annotated[float, Field(), AfterValidator(_not_zero)]


class _WordRow(_Strict):
    address: _Address


class _BitRow(_Strict):
    bit: Annotated[int, Field(ge=0, le=15)]
    address: _Address | None = None
    inverted: bool = False


class _StatusRow(_WordRow):
    bits: dict[str, _BitRow] = {}

    @field_validator("bits")
    @classmethod
    def _known(cls, bits: dict[str, _BitRow]) -> dict[str, _BitRow]:
        _only_status(list(bits))
        return bits


class _ChannelRow(_Strict):
    address: _Address
    type: WordType
    scale: _SignedScale = 1.0
    wraps: bool = False


class _AppliedRow(_Strict):
    address: _Address
    type: Literal["i16", "i32"]
    scale: _Scale


class _CorrectionRow(_Strict):
    address: _Address
    complement: _Address
    type: WordType
    scale: _Scale = 1.0
    limit_m_s: Annotated[float, Field(gt=0.0)]


class _ReadRows(_Strict):
    plc_heartbeat: _WordRow
    status: _StatusRow
    roll_id: _WordRow
    aff_echo: _WordRow | None = None
    applied: dict[str, _AppliedRow] = {}
    channels: dict[str, _ChannelRow]


class _WriteRows(_Strict):
    aff_heartbeat: _WordRow
    state: _WordRow
    echo: _WordRow
    alarm: _WordRow
    limit: _WordRow
    config_revision: _WordRow
    corrections: dict[str, _CorrectionRow]


class _SafetyRows(_Strict):
    watchdog_ms: Annotated[float, Field(gt=0.0)] = 80.0
    regain_ms: Annotated[float, Field(gt=0.0)] = 20.0
    fade_ms: Annotated[float, Field(gt=0.0)] = 100.0
    permissives: tuple[str, ...] = ("LINE_RUN", "WEB_INTACT", "TENSION_VALID", "ESTOP_OK")

    @field_validator("permissives", mode="before")
    @classmethod
    def _known(cls, names: object) -> object:
        if not isinstance(names, list):
            return names
        _only_status(names)
        return tuple(names)


class _MapFile(_Strict):
    version: Annotated[int, Field(ge=1, le=1)]
    address_base: Annotated[int, Field(ge=0, le=1)]
    word_order: Annotated[str, Field(pattern="^(high_first|low_first)$")]
    scan_ms: Annotated[float, Field(gt=0.0, le=1000.0)] | None = None
    read: _ReadRows
    write: _WriteRows
    safety: _SafetyRows = _SafetyRows()


def load_plc_map(path: Path) -> PlcMap:
    """Read a register map.

    Raises
    ------
    PlantError
        The file is missing, is not YAML, or says something a map must not.
    """
    try:
        rows = _MapFile.model_validate(load_yaml(path)[0])
        return _build(rows)
    except ValidationError as error:
        findings = "; ".join(
            f"{'.'.join(str(part) for part in row['loc'])}: {row['msg']}" for row in error.errors()
        )
        raise PlantError(f"{path}: {findings}") from error
    except (OSError, ValueError) as error:
        raise PlantError(f"{path}: {error}") from error


def _build(rows: _MapFile) -> PlcMap:
    base = rows.address_base
    read = {name: getattr(rows.read, name).address - base for name in _READ_WORDS}
    if rows.read.aff_echo is not None:
        read["aff_echo"] = rows.read.aff_echo.address - base
    write = {name: getattr(rows.write, name).address - base for name in _WRITE_WORDS}
    channels = tuple(
        RegisterItem(
            name=name, address=row.address - base, type=row.type, scale=row.scale, wraps=row.wraps
        )
        for name, row in rows.read.channels.items()
    )
    corrections = tuple(
        CorrectionItem(
            item=RegisterItem(
                name=name, address=row.address - base, type=row.type, scale=row.scale
            ),
            complement_address=row.complement - base,
            limit_m_s=row.limit_m_s,
        )
        for name, row in rows.write.corrections.items()
    )
    unknown = rows.read.applied.keys() - rows.write.corrections.keys()
    if unknown:
        raise ValueError(f"read.applied: {sorted(unknown)} have no correction")
    applied = tuple(
        RegisterItem(name=name, address=row.address - base, type=row.type, scale=row.scale)
        for name, row in rows.read.applied.items()
    )
    bits = tuple(_status_bits(rows.read.status, base))
    places = {one.address for one in bits} - {read["status"]}
    shown = [(item.address, item.length) for item in (*channels, *applied)]
    words = [*_spans(read), *shown, *((address, 1) for address in places)]
    read_start, read_count = _block("read", _MAX_READ, words)
    copies = ((c.complement_address, c.item.length) for c in corrections)
    values = ((c.item.address, c.item.length) for c in corrections)
    write_start, write_count = _block("write", _MAX_WRITE, [*_spans(write), *values, *copies])
    if read_start < write_start + write_count and write_start < read_start + read_count:
        raise ValueError("the read block and the write block overlap")
    permissives = Status(0)
    for name in rows.safety.permissives:
        permissives |= Status[name]
    return PlcMap(
        read=read,
        write=write,
        channels=channels,
        corrections=corrections,
        low_first=rows.word_order == "low_first",
        read_start=read_start,
        read_count=read_count,
        write_start=write_start,
        write_count=write_count,
        watchdog_s=rows.safety.watchdog_ms * 1e-3,
        regain_s=rows.safety.regain_ms * 1e-3,
        fade_s=rows.safety.fade_ms * 1e-3,
        permissives=permissives,
        applied=applied,
        scan_s=rows.scan_ms * 1e-3 if rows.scan_ms is not None else 0.0,
        status_bits=bits,
    )


def _status_bits(row: _StatusRow, base: int) -> Iterable[StatusBit]:
    for name, one in row.bits.items():
        at = row.address if one.address is None else one.address
        yield StatusBit(flag=Status[name], address=at - base, bit=one.bit, inverted=one.inverted)


def _spans(words: Mapping[str, int]) -> Iterable[tuple[int, int]]:
    return ((address, 1) for address in words.values())


def _block(name: str, longest: int, spans: Sequence[tuple[int, int]]) -> tuple[int, int]:
    used: set[int] = set()
    for address, length in spans:
        words = set(range(address, address + length))
        if address < 0 or address + length > 0x10000:
            raise ValueError(f"{name}: wire address {address} is outside 0..65535")
        if used & words:
            raise ValueError(f"{name}: wire address {min(used & words)} is used twice")
        used |= words
    start, count = min(used), max(used) - min(used) + 1
    if count > longest:
        raise ValueError(f"{name}: block of {count} words is longer than {longest}")
    return start, count
