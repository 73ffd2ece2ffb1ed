"""Writes an audit's lines; how many could not be written stands in it once there is room again."""

from __future__ import annotations

import logging

from aff_runtime.app.hand.audit import Audit, AuditEntry
from aff_runtime.base.errors import RefusedError
from aff_runtime.base.ports import Clock

RETRY_NS = 1_000_000_000
SHOWN_HASH = 12
LOG = logging.getLogger("aff_runtime")


class AuditWriter:
    """Writes lines into an audit that may be on a full disk.

    Parameters
    ----------
    without : what is not done while no line can be written, as the log says it.
    """

    def __init__(self, audit: Audit, clock: Clock, without: str) -> None:
        self._audit = audit
        self._clock = clock
        self._without = without
        self._fault = ""
        self._lost = 0  # lines that could not be written, and whose number is not yet either
        self._retry_ns = 0

    @property
    def last(self) -> int:
        """Number of the newest line."""
        return self._audit.last

    @property
    def is_kept(self) -> bool:
        """Whether every line since the audit was opened is in it, or in a number that it tells."""
        return not self._lost

    def write(self, entry: AuditEntry) -> int:
        """Write one line; its number, 0 when it cannot be.

        What could not be written is in the log alone; how many stands in the audit, first of all,
        once there is room again.
        """
        number = self._add(entry) if self._tells_lost() else 0
        if not number:
            self._lost += 1
        return number

    def kept_as(self, number: int) -> str:
        """Return what the log says of the line that has just been written."""
        if not number:
            return "not in the audit"
        return f"audit {number} {self._audit.newest[:SHOWN_HASH]}"

    def tend(self) -> None:
        """Try again, once a second, to say how many lines could not be written."""
        now_ns = self._clock.now_ns()
        if self._lost and now_ns >= self._retry_ns:
            self._retry_ns = now_ns + RETRY_NS
            self._tells_lost()

    def close(self) -> None:
        """End it."""
        self._tells_lost()
        self._audit.close()

    def _tells_lost(self) -> bool:
        """Put on record how many lines could not be written; False when that cannot be either."""
        if not self._lost:
            return True
        said = f"{self._lost} lines could not be written"
        number = self._add(AuditEntry(what="lost", result="noted", why=said))
        if number:
            self._lost = 0
            LOG.info("the audit is kept again: %s, says its line %d", said, number)
        return number > 0

    def _add(self, entry: AuditEntry) -> int:
        try:
            number = self._audit.add(entry)
        except RefusedError as error:
            if str(error) != self._fault:
                self._fault = str(error)
                LOG.error("the audit is not kept, %s: %s", self._without, error)
            return 0
        self._fault = ""
        return number
