"""Can this number be true? Range, NaN, stuck, rate and the direction of a roll's radius."""

from __future__ import annotations

from collections import deque
from math import inf, isfinite

from aff_runtime.safety.params import ChannelParams, RadiusParams

_EDGE_S = 1e-9  # rounding of summed periods
_RADII = 5  # readings of a median: two wrong ones in a row move it not at all


class ChannelCheck:
    """Judges one channel; call only with values of a good transaction. Never raises.

    While the line does not run only NaN and infinity count: a slack web reads no tension.
    """

    def __init__(self, params: ChannelParams) -> None:
        self.params = params
        self._last: float | None = None
        self._unchanged_s = 0.0

    def forget(self) -> None:
        """Begin anew: nothing was heard for so long that nobody knows what the value did."""
        self._last = None
        self._unchanged_s = 0.0

    def is_plausible(self, value: float, elapsed_s: float, running: bool) -> bool:
        """Return whether ``value`` can be true, ``elapsed_s`` after the last one."""
        last, self._last = self._last, value
        if not isfinite(value):
            self._last = None
            self._unchanged_s = 0.0
            return False
        if not running:
            self._unchanged_s = 0.0
            return True
        return (
            self.params.minimum <= value <= self.params.maximum
            and self._moves(value, last, elapsed_s)
            and self._rate_is_possible(value, last, elapsed_s)
        )

    def is_possible(self, value: float) -> bool:
        """Return whether ``value`` is of a size the signal can have, running or not.

        A line at rest may read less than its minimum, but nothing larger than either bound.
        """
        return abs(value) <= max(abs(self.params.minimum), abs(self.params.maximum))

    def _moves(self, value: float, last: float | None, elapsed_s: float) -> bool:
        self._unchanged_s = self._unchanged_s + elapsed_s if value == last else 0.0
        return self._unchanged_s < self.params.stuck_after_s - _EDGE_S

    def _rate_is_possible(self, value: float, last: float | None, elapsed_s: float) -> bool:
        if last is None or self.params.rate_max == inf:
            return True
        return abs(value - last) <= self.params.rate_max * elapsed_s


class RadiusCheck:
    """Judges that a roll only shrinks (or grows) until the next roll. Never raises.

    What the next radius is held against is the extreme of the median of the last few: a reading
    that is wrong, but just within the tolerance, does not make the right ones after it a fault.
    """

    def __init__(self, params: RadiusParams) -> None:
        self.params = params
        self._recent_m: deque[float] = deque(maxlen=_RADII)
        self._extreme_m: float | None = None

    def forget(self) -> None:
        """Accept the next radius whatever it is: another roll is on."""
        self._recent_m.clear()
        self._extreme_m = None

    def is_plausible(self, radius_m: float) -> bool:
        """Return whether ``radius_m`` follows from the radii before it."""
        if not (isfinite(radius_m) and radius_m > 0.0):
            return False
        extreme_m = self._extreme_m
        if extreme_m is not None and abs(radius_m - extreme_m) > self.params.tolerance_m:
            return False
        self._recent_m.append(radius_m)
        middle_m = sorted(self._recent_m)[len(self._recent_m) // 2]
        if extreme_m is None:
            self._extreme_m = middle_m
        elif self.params.shrinks:
            self._extreme_m = min(extreme_m, middle_m)
        else:
            self._extreme_m = max(extreme_m, middle_m)
        return True
