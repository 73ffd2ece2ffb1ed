"""An output is a lease: it dies unless the law renews it."""

from __future__ import annotations


class Lease:
    """Counts the ticks since the law last renewed its output; never raises."""

    def __init__(self, ticks: int) -> None:
        self._ticks = ticks
        self._unrenewed = 0

    def tick(self, renewed: bool) -> bool:
        """Count one tick and return True when the lease has run out."""
        self._unrenewed = 0 if renewed else self._unrenewed + 1
        return self._unrenewed > self._ticks
