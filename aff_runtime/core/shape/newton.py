"""The Newton steps by which every weight follows what the filter has found."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from aff_runtime.core.compiled.binary import chosen, holding
from aff_runtime.core.shape.kalman import ShapeFilter
from aff_runtime.core.shape.monitor import ShapeMonitor

NEWTON_TURNS = 0.5  # time constant of a weight, turns of its roll
RATIO_FROM, RATIO_TO = 1.0 / 3.0, 3.0  # |1 + d| outside counts as this in the rate of a step


class NewtonSteps:
    """Moves the weights, W_n <- W_n - rate m_n / (1 + d_n), and says how fast they move.

    Parameters
    ----------
    weight : what is moved, m. ``turn_s`` : of every column's roll.
    held : columns that stay for their response; None where none was measured.
    limit_m : largest size of one weight, where all together are larger.

    Attributes
    ----------
    step_1_s : size of the last step over its time, (columns,), m/s.
    """

    __slots__ = (
        "_compiled",
        "_filter",
        "_hold",
        "_limit_m",
        "_monitor",
        "_move",
        "_stays",
        "_turn_s",
        "_weight",
        "step_1_s",
    )

    def __init__(
        self,
        weight: npt.NDArray[np.complex128],
        found: ShapeFilter,
        *,
        turn_s: npt.NDArray[np.float64],
        monitor: ShapeMonitor,
        held: npt.NDArray[np.bool_] | None,
        limit_m: float,
    ) -> None:
        self._weight = weight
        self._filter = found
        self._turn_s = turn_s
        self._monitor = monitor
        self._stays = held
        self._limit_m = limit_m
        self._move = np.zeros(weight.size, dtype=np.complex128)
        self.step_1_s = np.zeros(weight.size)
        self._compiled = chosen()
        self._hold = holding(weight, self.step_1_s, found.deviation, found.response_ratio)

    def stay(self) -> None:
        """Move nothing in this tick."""
        self.step_1_s[:] = 0.0

    def step(self, dt_s: float) -> None:
        """Move every weight that does not rest and is not held."""
        calm, limit = self._monitor.calm, self._limit_m
        if self._compiled is not None:
            self._compiled.newton_step(
                self._hold,
                self._turn_s,
                None if calm else self._monitor.rest_turns,
                self._stays,
                *(NEWTON_TURNS, RATIO_FROM, RATIO_TO, limit, dt_s),
            )
            return
        ratio, move = self._filter.response_ratio, self._move
        np.multiply(ratio, self._weight, out=move)
        move += self._filter.deviation
        size = np.abs(ratio)
        share = -np.expm1(-dt_s / (NEWTON_TURNS * self._turn_s))
        share *= np.maximum(size, 1e-9) / np.minimum(np.maximum(size, RATIO_FROM), RATIO_TO)
        move *= share
        move /= ratio
        if not calm:
            move[self._monitor.resting] = 0.0
        if self._stays is not None:
            move[self._stays] = 0.0
        self._weight -= move
        if np.vdot(self._weight, self._weight).real > limit * limit:
            self._weight *= limit / np.maximum(np.abs(self._weight), limit)
        np.abs(move, out=self.step_1_s)
        self.step_1_s *= 1.0 / dt_s
