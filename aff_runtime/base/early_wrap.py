"""A count that starts over before its range ends: what it is, and what to write."""

from __future__ import annotations

import math
from dataclasses import dataclass

FEWEST_WRAPS = 3
"""That are alike, and as far apart as each is large: two may be a counter that was set anew."""
ALIKE_SHARE = 0.8
"""Of the steps that jump: so many are alike where a count starts over early."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EarlyWrap:
    """A count that starts over before its range ends.

    Attributes
    ----------
    range_rad : after which it does; ``off_rad`` : by which that may be off.
    seen : how often it did.
    """

    range_rad: float
    off_rad: float
    seen: int

    def words(self, modulus_rad: float, counts: int) -> str:
        """Return what to write into its channel, which has ``counts`` in ``modulus_rad``."""
        size_rad = modulus_rad / counts
        turn, found = math.tau / size_rad, self.range_rad / size_rad
        whole = round(found / turn) * turn
        is_whole = whole > 0.0 and abs(whole - found) <= self.off_rad / size_rad < 0.5 * turn
        after = round(whole if is_whole else found)
        return (
            f"its count starts over after {'' if is_whole else 'about '}{after} counts (seen "
            f"{self.seen} times), not after {counts}, and the service loses its phase each time: "
            f"write wraps_after: {after}"
        )
