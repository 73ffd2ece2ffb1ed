"""Whether a roll is there for the law: its angle is known and it was not just changed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from aff_runtime.core.phase import Quality, RollPhase

FADE_S = 0.3


class Presence:
    """A share (0..1) per column that fades out without an angle and after a change of roll.

    A predicted angle still counts: a few missing readings change nothing.
    """

    __slots__ = ("_leaving", "_phases", "_roll_of", "fade_s", "known", "moving", "share")

    def __init__(self, roll_of: Sequence[str], phases: Mapping[str, RollPhase]) -> None:
        self._phases = [phases[roll] for roll in roll_of]
        self._roll_of = np.array(roll_of)
        self._leaving = np.zeros(len(roll_of), dtype=bool)
        self.share = np.ones(len(roll_of))
        self.known = False
        self.moving = False
        self.fade_s = FADE_S

    def leave(self, roll: str) -> None:
        """Fade the columns of a roll that was changed, then have them forgotten."""
        self._leaving |= self._roll_of == roll

    def step(self, dt_s: float) -> npt.NDArray[np.bool_] | None:
        """Advance; return the columns to forget now, or None."""
        known = np.array([phase.quality is not Quality.LOST for phase in self._phases])
        self.known = bool(known.all())
        wanted = known & ~self._leaving
        self.moving = not bool((self.share == wanted).all())
        if not self.moving:
            return None
        change = dt_s / self.fade_s
        before = self.share
        self.share = np.clip(before + np.where(wanted, change, -change), 0.0, 1.0)
        gone = self._leaving & (self.share == 0.0)
        if not gone.any():
            return None
        self._leaving &= ~gone
        return np.asarray(gone, dtype=np.bool_)
