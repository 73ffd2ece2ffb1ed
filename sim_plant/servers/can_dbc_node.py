"""The simulated PLC on CAN by DBC; every bit through cantools' own codec."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cantools
from cantools.database.can import Database, Message
from pydantic import BaseModel, ConfigDict, ValidationError

from aff_runtime.base.effort import bounded_effort
from aff_runtime.base.errors import PlantError
from aff_runtime.base.printable import printable
from sim_plant.base.plain_file import read_plain
from sim_plant.line.yaml_file import LONGEST_BYTES, load_yaml
from sim_plant.servers.can_frames import CanFrame
from sim_plant.servers.faults import Fault
from sim_plant.servers.plant import Plant
from sim_plant.servers.registers import Registers


class _Rows(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class _Channel(_Rows):
    signal: str
    scale: float = 1.0
    wraps: bool = False


class _Correction(_Rows):
    signal: str
    complement: str


class DbcMap(_Rows):
    """Which signal of the DBC file carries what, as the PLC's programmer wrote it down."""

    version: int
    dbc: str
    read: Mapping[str, str]
    channels: Mapping[str, _Channel]
    write: Mapping[str, str]
    corrections: Mapping[str, _Correction]
    applied: Mapping[str, str] = {}


def load_dbc_map(path: Path) -> tuple[DbcMap, Database]:
    """Read the PLC's signal map and its DBC file.

    Raises
    ------
    PlantError
        A file is missing or says something it must not.
    """
    try:
        rows = DbcMap.model_validate(load_yaml(path)[0])
        file = path.parent / rows.dbc
        content = read_plain(file, LONGEST_BYTES).decode("cp1252", "replace")
        with bounded_effort(printable(str(file)), PlantError):
            database = cantools.database.load_string(content, database_format="dbc")
    except (OSError, ValidationError, ValueError, cantools.Error) as error:
        raise PlantError(f"{path}: {error}") from error
    if not isinstance(database, Database):
        raise PlantError(f"{path}: {rows.dbc} is no CAN database")
    return rows, database


_VALUE, _PAGE, _COUNTER = range(3)


@dataclass(frozen=True, slots=True)
class _Shown:
    """One signal of a message that the PLC sends."""

    name: str
    dotted: str
    kind: int
    pages: frozenset[int]
    low: float
    high: float
    blank: float
    half: int  # of a count that wraps; 0 for a value

    def fitting(self, value: float) -> float:
        """Return the value as the signal can say it: wrapped, or at the end of its range."""
        if math.isnan(value):
            return self.blank
        if self.half and math.isfinite(value):
            return float((round(value) + self.half) % (2 * self.half) - self.half)
        return min(max(value, self.low), self.high)


@dataclass(frozen=True, slots=True)
class _Plan:
    """A message that the PLC sends, looked up once."""

    message: Message
    rows: tuple[_Shown, ...]
    pages: tuple[int, ...]


def _plan(message: Message, wrapping: frozenset[str]) -> _Plan:
    rows = []
    for signal in message.signals:
        half = 1 << (signal.length - 1)
        dotted = f"{message.name}.{signal.name}"
        signed = signal.is_signed
        low = -half * signal.scale if signed else 0.0
        high = (half - 1 if signed else 2 * half - 1) * signal.scale
        kind = _PAGE if signal.is_multiplexer else _VALUE
        rows.append(
            _Shown(
                name=signal.name,
                dotted=dotted,
                kind=_COUNTER if signal.name == "Counter" else kind,
                pages=frozenset(signal.multiplexer_ids or ()),
                low=float(low),
                high=float(high),
                blank=float(low if signed else high),
                half=half if dotted in wrapping else 0,
            )
        )
    pages = sorted({page for row in rows for page in row.pages})
    return _Plan(message, tuple(rows), tuple(pages))


class DbcNode:
    """The PLC's CAN interface.

    A scan sends every PLC message once, the one with the heartbeat last. What the runtime sends
    counts when all its messages have come with the counter of one heartbeat; then the words
    change at once, as one Modbus write would change them.

    Attributes
    ----------
    torn : sets of the runtime that never became whole.
    channels : measured channels that it shows.
    """

    def __init__(self, rows: DbcMap, database: Database, registers: Registers) -> None:
        self._rows = rows
        self._registers = registers
        self.torn = 0
        self.channels = frozenset(rows.channels)
        self._last: list[CanFrame] = []
        self._pending: dict[str, dict[str, float]] = {}
        self._words: dict[str, int] = {}
        shown = [*rows.read.values(), *_signals(rows.channels), *rows.applied.values()]
        ours = _messages(database, shown)
        pairs = [(c.signal, c.complement) for c in rows.corrections.values()]
        theirs = [*rows.write.values(), *(name for pair in pairs for name in pair)]
        self._theirs = {m.frame_id: m for m in _messages(database, theirs)}
        heartbeat, _, beat = rows.read["plc_heartbeat"].partition(".")
        ours.sort(key=lambda message: (message.name == heartbeat, message.frame_id))
        self._beats = 1 << ours[-1].get_signal_by_name(beat).length
        wrapping = frozenset(c.signal for c in rows.channels.values() if c.wraps)
        self._ours = [_plan(message, wrapping) for message in ours]
        self._aff_heartbeat = tuple(rows.write["aff_heartbeat"].split(".", 1))

    def reset(self) -> list[CanFrame]:
        """Forget what was heard."""
        self._pending.clear()
        self._words.clear()
        return []

    def take(self, frame: CanFrame) -> list[CanFrame]:
        """Take a frame of the runtime."""
        message = self._theirs.get(frame.can_id)
        if message is None or message.is_extended_frame != frame.extended:
            return []
        if len(frame.data) != message.length:
            return []
        raw: Any = message.decode(frame.data, decode_choices=False, scaling=False)
        self._pending[message.name] = dict(raw)
        name, signal = self._aff_heartbeat
        head = self._pending.get(name)
        if head is None or len(self._pending) < len(self._theirs):
            return []
        low = int(head[signal]) & 0xFF
        if all(row.get("Counter", low) == low for row in self._pending.values()):
            self._accept()
        return []

    def publish(self, plant: Plant) -> list[CanFrame]:
        """Return the frames of one scan."""
        if plant.faults.active(Fault.FREEZE) and self._last:
            return self._last
        words = plant.registers.read_words
        plc_map = plant.plc.map
        shown = {name: words[at - plc_map.read_start] for name, at in plc_map.read.items()}
        heartbeat = shown["plc_heartbeat"]
        values: dict[str, float] = {s: shown[n] for n, s in self._rows.read.items()}
        values[self._rows.read["plc_heartbeat"]] = heartbeat % self._beats
        for name, channel in self._rows.channels.items():
            values[channel.signal] = plant.shown.measured[name] / channel.scale
        for name, signal in self._rows.applied.items():
            values[signal] = plant.shown.applied_m_s[name]
        self._last = [self._encode(plan, values, heartbeat) for plan in self._ours]
        return self._last

    def second_master(self) -> list[CanFrame]:
        """Return the runtime's messages, all zero but for a moving heartbeat."""
        return [
            CanFrame(m.frame_id, m.is_extended_frame, bytes(m.length))
            for m in self._theirs.values()
        ]

    def _accept(self) -> None:
        """Copy a whole set into the PLC's write block."""
        plc_map, block = self._registers.plc_map, list(self._registers.write_words)
        for name, dotted in self._rows.write.items():
            message, signal = dotted.split(".", 1)
            if signal in self._pending[message]:
                self._words[name] = int(self._pending[message][signal])
            block[plc_map.write[name] - plc_map.write_start] = self._words.get(name, 0) & 0xFFFF
        for row in plc_map.corrections:
            pair = self._rows.corrections[row.item.name]
            addresses = (row.item.address, row.complement_address)
            for dotted, address in zip((pair.signal, pair.complement), addresses, strict=True):
                message, signal = dotted.split(".", 1)
                block[address - plc_map.write_start] = int(self._pending[message][signal]) & 0xFFFF
        self._registers.write(plc_map.write_start, block)
        for theirs in self._theirs.values():
            if any(signal.name == "Counter" for signal in theirs.signals):
                del self._pending[theirs.name]

    def _encode(self, plan: _Plan, values: Mapping[str, float], heartbeat: int) -> CanFrame:
        chosen: dict[str, float] = {}
        page = plan.pages[heartbeat % len(plan.pages)] if plan.pages else None
        for row in plan.rows:
            if row.kind == _PAGE and page is not None:
                chosen[row.name] = page
            elif row.kind == _COUNTER:
                chosen[row.name] = heartbeat & 0xFF
            elif row.dotted in values and (not row.pages or page in row.pages):
                chosen[row.name] = row.fitting(values[row.dotted])
        message = plan.message
        data = message.encode(chosen, strict=False)
        return CanFrame(message.frame_id, message.is_extended_frame, bytes(data))


def _signals(channels: Mapping[str, _Channel]) -> list[str]:
    return [channel.signal for channel in channels.values()]


def _messages(database: Database, signals: list[str]) -> list[Message]:
    names = dict.fromkeys(signal.partition(".")[0] for signal in signals)
    try:
        return [database.get_message_by_name(name) for name in names]
    except KeyError as error:
        raise PlantError(f"the DBC file has no message {error}") from error
