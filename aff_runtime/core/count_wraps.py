"""Does the count of an encoder start over before its range ends? Told while the line runs."""

from __future__ import annotations

import math
from collections import deque
from itertools import pairwise

from aff_runtime.base.early_wrap import ALIKE_SHARE, FEWEST_WRAPS, EarlyWrap
from aff_runtime.core.long_gap import JUMP_RAD
from aff_runtime.core.params import RollParams

KEPT = 2 * FEWEST_WRAPS
"""Jumps that are looked at, the newest: what is settled is told, what was mended is forgotten."""


class CountWraps:
    """Jumps of a count that the roll did not make, and the range that they tell.

    A count that starts over early is off by the same each time, and counts that far in between.

    Parameters
    ----------
    params : the roll's, with the range of its encoder's count by the site file.
    """

    __slots__ = ("_at_rad", "_back_rad", "_begun", "_modulus", "_p", "seen")

    def __init__(self, params: RollParams) -> None:
        self._p = params
        self._modulus = params.angle_modulus_rad or 0.0
        self._begun = (math.nan, math.nan)
        self._back_rad: deque[float] = deque(maxlen=KEPT)
        self._at_rad: deque[float] = deque(maxlen=KEPT)
        self.seen = 0

    def begin(self, turned_rad: float, expected_rad: float, theta_rad: float) -> None:
        """Take a reading that does not fit: by the count, and by the speed, since the last one.

        ``theta_rad`` : angle of the roll at the last one that did; NaN in any: nobody knows.
        """
        way = math.copysign(1.0, expected_rad)
        off_rad = way * (expected_rad - turned_rad)
        self._begun = (off_rad, way * theta_rad)

    def confirm(self) -> None:
        """Take what did not fit for a jump: the readings after it agree with it."""
        off_rad, at_rad = self._begun
        self._begun = (math.nan, math.nan)
        if self._modulus > 0.0 and math.isfinite(off_rad + at_rad):
            self._back_rad.append(off_rad % self._modulus)
            self._at_rad.append(at_rad)
            self.seen += 1

    def note(self) -> str:
        """Return that the count starts over early, and what to write; else empty."""
        found, counts = self.found(), self._p.angle_counts
        if found is None or not counts:
            return ""
        return f"{self._p.name}: {self._p.angle}: {found.words(self._modulus, counts)}"

    def found(self) -> EarlyWrap | None:
        """Return after what the count starts over, None where it does not, or who knows."""
        if len(self._back_rad) < FEWEST_WRAPS:
            return None
        at_rad = tuple(self._at_rad)
        range_rad = sorted(self._back_rad)[len(at_rad) // 2]
        alike = [abs(back - range_rad) <= JUMP_RAD for back in self._back_rad]
        apart = (abs(b - a) for a, b in pairwise(at_rad))
        due = [abs(math.remainder(one, range_rad)) <= 2.0 * JUMP_RAD for one in apart]
        is_told = min(sum(alike) / len(alike), sum(due) / len(due)) >= ALIKE_SHARE
        if not is_told or range_rad < 4.0 * JUMP_RAD:
            return None
        return EarlyWrap(range_rad=range_rad, off_rad=JUMP_RAD, seen=self.seen)
