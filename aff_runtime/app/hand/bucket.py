"""A token bucket: so many things a second, and a few more at once after a pause."""

from __future__ import annotations

from aff_runtime.base.ports import Clock


class Bucket:
    """Holds one token per thing that may be done now; fills up again with time.

    Parameters
    ----------
    per_s : how many a second for long. ``burst`` : how many at once after a pause.
    """

    def __init__(self, clock: Clock, *, per_s: float, burst: float) -> None:
        self._clock = clock
        self._per_s = per_s
        self._burst = burst
        self._left = burst
        self._since_ns = clock.now_ns()

    def take(self) -> bool:
        """Take one token; False when there is none."""
        now_ns = self._clock.now_ns()
        self._left += self._per_s * (now_ns - self._since_ns) * 1e-9
        self._left, self._since_ns = min(self._burst, self._left), now_ns
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True

    @property
    def is_full(self) -> bool:
        """Whether it holds as many as it can."""
        since_s = (self._clock.now_ns() - self._since_ns) * 1e-9
        return self._left + self._per_s * since_s >= self._burst

    def put_back(self) -> None:
        """Return a token that was taken for what does not count after all."""
        self._left = min(self._burst, self._left + 1.0)
