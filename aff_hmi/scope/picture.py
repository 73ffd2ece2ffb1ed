"""A shot on its way out: as bytes for the page, as a table for a spreadsheet."""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from datetime import UTC, datetime

import numpy as np
from numpy.typing import NDArray

from aff_hmi.scope.shot import LONGEST, Shot, ShotRequest
from aff_hmi.scope.signals import THETA, Signal
from aff_hmi.scope.spectrum import lines_of
from aff_hmi.scope.ticks import Cut
from aff_hmi.scope.turns import orders_of, turns_of
from aff_hmi.words import Say
from aff_runtime.base.events import BY_CODE
from aff_runtime.base.numbers import finite_or_none
from aff_runtime.base.printable import printable
from aff_runtime.base.signals import State

SHOWN_EVENTS = 20
_LENGTH = struct.Struct("<I")


@dataclass(frozen=True, slots=True, kw_only=True)
class Orders:
    """Amplitude of each order, and of the noise between them; None where it is not known."""

    amplitudes: list[float | None]
    floor: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Mark:
    """Something that happened, ``at_s`` after the first tick."""

    at_s: float
    name: str


def encode(shot: Shot, asked: ShotRequest, say: Say, ring: str = "") -> bytes:
    """Return a shot as bytes: length of a head in JSON, head, times, signals, turns.

    Times are float64 from the first tick, s; the rest float32 in the order of the head, all
    little-endian; NaN where nothing is known. The head is filled up to whole eight bytes.
    ``ring`` : of whose ticks they are, empty for those that are kept.
    """
    cut = shot.cut
    columns = [cut.of(name) for name in asked.names]
    turns = turns_of(cut.of(asked.roll + THETA)) if asked.roll else None
    head = {
        "ok": True,
        "n": len(cut),
        "ring": ring,
        "first": int(cut.ticks[0]) if len(cut) else -1,
        "last": int(cut.ticks[-1]) if len(cut) else -1,
        "utc_s": round(cut.utc_s + float(cut.time_s[0]), 4) if len(cut) else None,
        "cycle_s": cut.cycle_s,
        "trigger": shot.at,
        "trigger_tick": int(cut.ticks[shot.at]) if shot.at is not None else None,
        "missed": _missed(cut),
        "signals": [
            {"name": one.name, "label": one.words(say), "unit": one.unit}
            for one in _wanted(cut, asked)
        ],
        "turns": turns is not None,
        "orders": [asdict(_orders(turns, column)) for column in columns]
        if turns is not None
        else [],
        "lines": [_lines(cut, column) for column in columns] if asked.wants_lines else [],
        "marks": [asdict(one) for one in _marks(cut)],
    }
    text = json.dumps(head, ensure_ascii=False, allow_nan=False).encode()
    text += b" " * (-(len(text) + _LENGTH.size) % 8)
    times = (cut.time_s - cut.time_s[0]) if len(cut) else cut.time_s
    parts = [_LENGTH.pack(len(text)), text, times.astype("<f8").tobytes()]
    parts += [column.astype("<f4").tobytes() for column in columns]
    if turns is not None:
        parts.append(turns.astype("<f4").tobytes())
    return b"".join(parts)


def waiting() -> bytes:
    """Return the bytes that say that a trigger has not fired."""
    text = json.dumps({"ok": True, "n": -1}).encode()
    text += b" " * (-(len(text) + _LENGTH.size) % 8)
    return _LENGTH.pack(len(text)) + text


def table(shot: Shot, asked: ShotRequest) -> Iterator[list[str]]:
    """Yield the rows of a file, the names first: exactly the ticks and signals that are shown."""
    cut = shot.cut
    wanted = _wanted(cut, asked)
    turns = turns_of(cut.of(asked.roll + THETA)) if asked.roll else None
    names = [printable(one.name, LONGEST) for one in wanted]
    units = [f" [{one.unit}]" if one.unit else "" for one in wanted]
    named = [name + unit for name, unit in zip(names, units, strict=True)]
    named += [f"turns of {printable(asked.roll, LONGEST)}"] if asked.roll else []
    yield ["utc", "tick", "time_s", "state", *named]
    columns = [cut.of(one.name) for one in wanted] + ([turns] if turns is not None else [])
    for n in range(len(cut)):
        utc = datetime.fromtimestamp(cut.utc_s + float(cut.time_s[n]), UTC)
        cells = ["" if math.isnan(column[n]) else f"{column[n]:.6g}" for column in columns]
        head = [utc.isoformat(timespec="milliseconds"), str(cut.ticks[n]), f"{cut.time_s[n]:.6f}"]
        yield [*head, _state(int(cut.states[n])), *cells]


def _wanted(cut: Cut, asked: ShotRequest) -> list[Signal]:
    signals = {one.name: one for one in cut.signals}
    return [signals[name] for name in asked.names]


def _orders(turns: NDArray[np.float64], column: NDArray[np.float32]) -> Orders:
    amplitudes, floor = orders_of(turns, column)
    return Orders(
        amplitudes=[finite_or_none(one, 5) for one in amplitudes.tolist()],
        floor=finite_or_none(floor, 5),
    )


def _lines(cut: Cut, column: NDArray[np.float32]) -> list[list[float]]:
    found = lines_of(cut.time_s, column, cut.cycle_s)
    return [[float(f"{f_Hz:.5g}"), float(f"{size:.4g}")] for f_Hz, size in found]


def _marks(cut: Cut) -> Iterator[Mark]:
    """Yield what happened in the window: changes of state, events of the service."""
    changes = np.flatnonzero(np.diff(cut.states) != 0) + 1
    marks = [(int(at), _state(int(cut.states[at]))) for at in changes]
    for tick, code in cut.events:
        name = BY_CODE[code].name if code in BY_CODE else f"CODE {code}"
        marks.append((int(np.searchsorted(cut.ticks, tick)), name))
    for at, name in sorted(marks)[:SHOWN_EVENTS]:
        yield Mark(at_s=round(float(cut.time_s[at] - cut.time_s[0]), 6), name=name)


def _missed(cut: Cut) -> int:
    """Return how many ticks are missing between those that are there."""
    steps = np.rint(np.diff(cut.time_s) / cut.cycle_s) if cut.cycle_s else np.zeros(0)
    return int(np.sum(steps[steps > 1.0] - 1.0))


def _state(code: int) -> str:
    return State(code).name if code in State._value2member_map_ else str(code)
