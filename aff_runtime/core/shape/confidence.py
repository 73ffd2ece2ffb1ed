"""Which orders may go out: those whose response is known well enough at their frequency."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np
import numpy.typing as npt

from aff_runtime.core.response import MAX_PHASE_ERROR_RAD, Response, arming_objections
from aff_runtime.core.shape.basis import ShapeBasis
from aff_runtime.core.shape.columns import ColumnState

Floats = npt.NDArray[np.float64]
FADE_S = 1.0  # of a share, from 1 to 0
RENEWED_PER_TICK = 2  # columns


class Monitor(Protocol):
    """Measures of every column whether its correction helps."""

    def is_settled(self, at: int) -> bool:
        """Return whether column ``at`` is quiet by its correction, as measured."""
        ...


class ResponseConfidence:
    """A share (0..1) per column; one whose phase could be wrong by 60 degrees fades and rests.

    A column that goes out and is settled goes on, as long as it is: its correction is seen to
    help, so nothing need be forecast of its phase. As the roll unwinds, orders leave the
    frequencies that a probe heard well. Were the phase wrong there, the ripple would grow, and
    the column rest after all. One that rests comes back by its response alone.

    Without a measured response (a declared line's own) every column is trusted. Columns are
    looked at in turn, a few per tick, so that none of them makes a tick long.
    """

    __slots__ = ("_monitor", "_next", "_response", "_settled", "held", "moving", "share")

    def __init__(self, state: ColumnState, response: Response | None, monitor: Monitor) -> None:
        self._response = response
        self._monitor = monitor
        self._next = 0
        self.held = state.array("confidence.held", False, dtype=np.bool_)
        self.share = state.array("confidence.share", 1.0)
        self.moving = False
        self._settled = False

    def judge(self, frequency_Hz: Floats) -> None:
        """Look at every column at once, at the start and before arming."""
        for at in range(self.held.size):
            self._look(at, frequency_Hz.item(at))

    def step(self, frequency_Hz: Floats, dt_s: float) -> None:
        """Advance: renew a few columns, move all shares."""
        if self._response is None:
            return
        for _ in range(RENEWED_PER_TICK):
            self._next = (self._next + 1) % self.held.size
            self._look(self._next, frequency_Hz.item(self._next))
        if self._settled:
            return
        target = np.where(self.held, 0.0, 1.0)
        self.moving = not bool((self.share == target).all())
        self._settled = not self.moving
        if self.moving:
            change = dt_s / FADE_S
            self.share += np.clip(target - self.share, -change, change)

    def objections(self, basis: ShapeBasis, roll_of: Sequence[str], own: str) -> tuple[str, ...]:
        """Return why nothing may go out: no order of the roll ``own`` has a sure response."""
        if self._response is None:
            return ()
        self.judge(basis.frequency_Hz)
        end_rad_s = math.tau * basis.band.end_Hz
        columns = zip(basis.names, basis.order, basis.omega_rad_s, roll_of, self.held, strict=True)
        wanted = [
            (name, n * w / math.tau)
            for name, n, w, roll, held in columns
            if roll == own and not held and abs(n * w) < end_rad_s
        ]
        if not wanted:
            return (f"no order of {own} has a sure response; run the probe",)
        found = [arming_objections(self._response, [one]) for one in wanted]
        return () if not all(found) else tuple(text for texts in found for text in texts)

    def adopt(self) -> None:
        """Go on with shares that were taken over."""
        self._settled = False

    def _look(self, at: int, frequency_Hz: float) -> None:
        if self._response is not None and frequency_Hz > 0.0:
            bound = self._response.phase_error_bound_rad(frequency_Hz)
            held = bound > MAX_PHASE_ERROR_RAD
            was_held = self.held.item(at)
            if held and not was_held and self._monitor.is_settled(at):
                return
            if held is not was_held:
                self.held[at] = held
                self._settled = False
