"""Run lines of one make together, one to a lane."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence

import numpy as np

from sim_plant.base.arrays import Array, LineArrays, LineState
from sim_plant.base.c_arrays import c_array, c_struct
from sim_plant.lanes.packing import SHARED_STATE, PackedLines, Words, space, together
from sim_plant.line.equations.kernel import Work
from sim_plant.line.running.references import References
from sim_plant.line.running.simulation import LineSimulation

_ARRAY_AXES = {name: 2 if name.startswith("shape_") else 1 for name in LineArrays._fields}
_STATE_AXES = {
    name: 2 if name == "delay_m_s" else 1 for name in LineState._fields if name not in SHARED_STATE
}
_WORK_AXES = {name: 2 if name in ("contacts", "rates") else 1 for name in Work._fields}


class SideBySide:
    """Lines of one make (``make_of``), as many as the binary has lanes or fewer.

    A line that diverges disturbs no other; its state is then not finite.
    """

    def __init__(self, library: ctypes.CDLL, width: int, lines: Sequence[LineSimulation]) -> None:
        self.lines = list(lines)
        self._library = library
        self._packed = PackedLines(lines, width)

    def run(self, given: References, columns: Sequence[int] = (), every: int = 0) -> list[Array]:
        """Run all lines under references; return (rows, columns) of the log of each.

        ``every``: a row after each so many frames; 0 for none.
        """
        frames = given.line_speed_m_s.shape[0]
        noise = self._noise(frames)  # before the rest: whether there is some stands in timing
        p, state, work = self._packed.arrays(), self._packed.state(), self._packed.work()
        width = len(self._packed.lines)
        out = space((frames // every if every else 0, len(columns), width))
        row = space((self.lines[0].log.width, width))
        wanted = np.array(columns, dtype=np.int64)
        layout = self.lines[0].layout
        self._library.line_frames(
            ctypes.byref(c_struct(p, _ARRAY_AXES)),
            ctypes.byref(c_struct(layout)),
            ctypes.byref(c_struct(state, _STATE_AXES)),
            ctypes.byref(c_struct(work, _WORK_AXES)),
            *(ctypes.byref(c_array(part, 2)) for part in (*given, noise)),
            ctypes.byref(c_array(row, 1)),
            ctypes.byref(c_array(wanted, 1)),
            ctypes.c_int64(every),
            ctypes.byref(c_array(out, 2)),
        )
        self._packed.put_back(p, state, work)
        return [out[..., lane] for lane in range(len(self.lines))]

    def _noise(self, frames: int) -> Words:
        mine = [line.noise(frames) for line in self.lines]
        return together(mine + [mine[-1]] * (len(self._packed.lines) - len(mine)))
