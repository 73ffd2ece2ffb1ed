"""Whether a roll is there for the law: its angle is known and it was not just exchanged."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from aff_runtime.core.gate import ANGLE_FADE_S
from aff_runtime.core.phase import Quality, RollPhase
from aff_runtime.core.shape.columns import ColumnState

LOST = Quality.LOST


class RollAvailability:
    """Per column the share (0..1) of its correction that goes out.

    It fades to 0 without an angle, and after the roll was exchanged.

    A predicted angle still counts: a few missing readings change nothing.
    ``share_changes``: some share is on its way. ``known``: every roll has an angle. ``leaving``:
    columns that fade to be forgotten.
    """

    __slots__ = (
        "_calm",
        "_index",
        "_phases",
        "_roll_of",
        "fade_s",
        "known",
        "leaving",
        "share",
        "share_changes",
    )

    def __init__(
        self, state: ColumnState, roll_of: Sequence[str], phases: Mapping[str, RollPhase]
    ) -> None:
        rolls = list(dict.fromkeys(roll_of))
        self._phases = [phases[roll] for roll in rolls]
        self._roll_of = np.array(roll_of)
        self._index = np.array([rolls.index(roll) for roll in roll_of])
        self.leaving = state.array("availability.leaving", False, dtype=np.bool_)
        self.share = state.array("availability.share", 1.0)
        self._calm = False
        self.known = False
        self.share_changes = False
        self.fade_s = ANGLE_FADE_S

    def leave(self, roll: str) -> None:
        """Fade the columns of a roll that was exchanged, then have them forgotten."""
        self.leaving[self._roll_of == roll] = True
        self._calm = False

    def adopt(self, old: RollAvailability) -> None:
        """Go on where ``old`` stands, once the shares are taken over; the angles are its own."""
        self.known = old.known
        self._calm = False

    def step(self, dt_s: float) -> npt.NDArray[np.bool_] | None:
        """Advance; return the columns to forget now, or None."""
        self.known = True
        for phase in self._phases:
            if phase.quality is LOST:
                self.known = False
        if self.known and self._calm:
            return None
        seen = [phase.quality is not LOST for phase in self._phases]
        wanted = np.array(seen)[self._index] & ~self.leaving
        self.share_changes = not bool((self.share == wanted).all())
        self._calm = self.known and not self.share_changes
        if self.share_changes:
            change = dt_s / self.fade_s
            np.clip(self.share + np.where(wanted, change, -change), 0.0, 1.0, out=self.share)
        elif not self.leaving.any():
            return None
        gone = self.leaving & (self.share == 0.0)
        if not gone.any():
            return None
        self.leaving[gone] = False
        self._calm = False
        return np.asarray(gone, dtype=np.bool_)
