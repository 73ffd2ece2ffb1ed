"""Lines in lanes: their arrays with one more axis, the lane, behind all others."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from sim_plant.base.arrays import CHANGE, CHANGEABLE, RIPPLE, Array, LineArrays, LineState, Records
from sim_plant.geometry.table import DEFAULT_POINTS
from sim_plant.line.equations.kernel import Work
from sim_plant.line.running.simulation import LineSimulation

SHARED_STATE = ("counters", "time_s")
"""Of the state: one for all lanes."""
TABLES = ("shape_h_m", "shape_dh_m", "shape_rho_m")
CHANGED = ("changes", *dict.fromkeys(number.split(".")[0] for number in CHANGEABLE))
"""Of the parameters: those that a run may write."""
_ALIGNMENT = 64
Words = np.ndarray[Any, np.dtype[Any]]


def space(shape: tuple[int, ...], dtype: npt.DTypeLike = np.float64) -> Words:
    """Return an array, not filled, that begins where vectors begin; elements of 8 bytes."""
    size = math.prod(shape) * 8
    memory = np.empty(size + _ALIGNMENT, np.uint8)
    first = -memory.ctypes.data % _ALIGNMENT
    return memory[first : first + size].view(dtype).reshape(shape)


def together(parts: Sequence[Words]) -> Words:
    """Return arrays of one shape side by side, the lanes last."""
    made = space((*parts[0].shape, len(parts)), parts[0].dtype)
    for lane, part in enumerate(parts):
        made[..., lane] = part
    return made


def words(records: Records) -> Words:
    """Return records as (records, fields) words of 8 bytes, the same memory."""
    return records.view(np.int64).reshape(records.size, records.dtype.itemsize // 8)


def make_of(line: LineSimulation) -> bytes:
    """Return what lines must have in common to run side by side."""
    p = line.arrays
    shaped = bool(np.any(p.bodies["shape_row"] >= 0))
    sizes = (*line.layout, p.loops.size, p.shape_h_m.shape[1] if shaped else DEFAULT_POINTS + 1)
    parts = (
        np.array(sizes),
        p.bodies["kind"],
        p.bodies["carriage"],
        p.spans["heat_first"],
        p.spans["heat_parts"],
        p.carriages["pendulum"],
        p.drives["body"],
        p.drives["loop"],
        p.cells["body"],
        p.loops["cell"],
        p.loops["carriage"],
        words(p.timing)[0],
    )
    return b"".join(np.ascontiguousarray(part).tobytes() for part in parts)


class PackedLines:
    """The arrays of several lines of one make, one line to a lane; the last one fills up.

    ``put_back`` writes what a run changes into the lines. Shape tables are packed once: no run
    changes them.
    """

    def __init__(self, lines: Sequence[LineSimulation], width: int) -> None:
        self.lines = [*lines, *[lines[-1]] * (width - len(lines))]
        self._used = len(lines)
        tables = [self._table(name) for name in TABLES]
        self._tables = dict(zip(TABLES, tables, strict=True))

    def _table(self, name: str) -> Array:
        found = [getattr(line.arrays, name) for line in self.lines]
        used = [line.arrays.bodies["shape_row"].max() + 1 for line in self.lines]
        rows = max(1, *used)
        columns = max(t.shape[1] for t, n in zip(found, used, strict=True)) if max(used) else 9
        padded = np.zeros((len(found), rows, columns))
        for lane, (table, number) in enumerate(zip(found, used, strict=True)):
            if number:
                padded[lane, :number] = table[:number]
        return together(list(padded))

    def arrays(self) -> LineArrays:
        """Return the parameters as they are now; ripples and changes with rows that do nothing."""
        given = [line.arrays for line in self.lines]
        most = max(p.ripples.size for p in given), max(p.changes.size for p in given)
        packed: dict[str, Words] = {}
        for name in LineArrays._fields:
            if name in TABLES:
                packed[name] = self._tables[name]
                continue
            parts = [getattr(p, name) for p in given]
            if name == "ripples":
                parts = [_padded(part, _no_ripples(most[0])) for part in parts]
            elif name == "changes":
                parts = [_padded(part, _no_changes(most[1])) for part in parts]
            packed[name] = together([words(part) for part in parts])
        return LineArrays(**packed)

    def state(self) -> LineState:
        """Return the states as they are now."""
        first = self.lines[0].state
        return LineState(
            **{
                name: getattr(first, name).copy()
                if name in SHARED_STATE
                else together([getattr(line.state, name) for line in self.lines])
                for name in LineState._fields
            }
        )

    def work(self) -> Work:
        """Return the scratch memory as it is now."""
        works = [line.work for line in self.lines]
        return Work(**{name: together([getattr(w, name) for w in works]) for name in Work._fields})

    def put_back(self, p: LineArrays, state: LineState, work: Work) -> None:
        """Write parameters that changed, states and tensions into the lines."""
        for lane, line in enumerate(self.lines[: self._used]):
            for name in CHANGED:
                mine = words(getattr(line.arrays, name))
                mine[:] = getattr(p, name)[: len(mine), :, lane]
            for name in LineState._fields:
                packed = getattr(state, name)
                getattr(line.state, name)[:] = (
                    packed if name in SHARED_STATE else packed[..., lane]
                )
            line.work.contacts[:] = work.contacts[..., lane]
            line.work.tensions[:] = work.tensions[..., lane]


def _padded(records: Records, neutral: Records) -> Records:
    made = neutral.copy()
    made[: records.size] = records
    return made


def _no_ripples(number: int) -> Records:
    made = np.zeros(number, RIPPLE)
    made["drive"] = -1
    return made


def _no_changes(number: int) -> Records:
    made = np.zeros(number, CHANGE)
    made["target"], made["from_s"], made["until_s"] = -1, np.inf, np.inf
    return made
