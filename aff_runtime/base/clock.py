"""The only clocks: a real one, and one that tests turn by hand."""

from __future__ import annotations

import time
from datetime import UTC, datetime


class MonotonicClock:
    """Real monotonic time."""

    def now_ns(self) -> int:
        """Return monotonic time, ns."""
        return time.monotonic_ns()

    def sleep_until_ns(self, deadline_ns: int) -> None:
        """Sleep to an absolute deadline."""
        wait_ns = deadline_ns - time.monotonic_ns()
        if wait_ns > 0:
            time.sleep(wait_ns * 1e-9)


class VirtualClock:
    """Time that moves only when told; sleeping moves it."""

    def __init__(self, start_ns: int = 0) -> None:
        self._now_ns = start_ns

    def now_ns(self) -> int:
        """Return virtual time, ns."""
        return self._now_ns

    def sleep_until_ns(self, deadline_ns: int) -> None:
        """Jump to ``deadline_ns`` unless it has passed."""
        self._now_ns = max(self._now_ns, deadline_ns)

    def advance_ns(self, step_ns: int) -> None:
        """Move time by ``step_ns``."""
        self._now_ns += step_ns


def wall_time_iso() -> str:
    """Return wall time, UTC, ISO 8601; for run headers and labels only."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")


def wall_time_s() -> float:
    """Return wall time as the kernel stamps packets with it, s; for the age of a stamp only."""
    return time.time()
