"""The only clock, and wall time for labels."""

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


def wall_time_iso() -> str:
    """Return wall time, UTC, ISO 8601; for run headers, labels, and days that people noted."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")


def wall_time_s() -> float:
    """Return wall time as the kernel stamps packets with it, s; for the age of a stamp only."""
    return time.time()
