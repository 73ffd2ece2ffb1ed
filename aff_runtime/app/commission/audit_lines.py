"""What the commissioner writes into its audit, and into its log."""

from __future__ import annotations

import logging
from dataclasses import replace

from aff_runtime.app.hand.audit import Audit, Entry
from aff_runtime.app.supervisor.hand.quotas import Quota
from aff_runtime.base.errors import RefusedError
from aff_runtime.base.ports import Clock

LOG = logging.getLogger("aff_runtime")


class AuditLines:
    """Writes lines; of a flood of refusals the count alone: it pushes no other line out."""

    def __init__(self, audit: Audit, clock: Clock) -> None:
        self._audit = audit
        self._lines = Quota(clock, per_s=0.1, burst=60.0)
        self._unwritten = 0
        self._fault = ""

    def write(self, entry: Entry, result: str, why: str = "") -> bool:
        """Write a line; False when it cannot be."""
        try:
            number = self._audit.add(replace(entry, result=result, why=why))
        except RefusedError as error:
            if str(error) != self._fault:
                self._fault = str(error)
                LOG.error("the audit is not kept, nothing is done: %s", error)
            return False
        self._fault = ""
        by = f" by {entry.account}" if entry.account else ""
        said = f" ({why})" if why else ""
        kept = f"audit {number} {self._audit.newest[:12]}"
        LOG.info("%s %s%s%s; %s", entry.what, result, by, said, kept)
        return True

    def refuse(self, entry: Entry, why: str) -> None:
        """Write a refusal, or count it where there were too many."""
        if self._unwritten == 0 and self._lines.take():
            self.write(entry, "refused", why)
        else:
            self._unwritten += 1

    def tend(self) -> None:
        """Say how many refusals were not written, once another line may be."""
        if self._unwritten and self._lines.take():
            self._say_unwritten()

    def close(self) -> None:
        """End it."""
        if self._unwritten:
            self._say_unwritten()
        self._audit.close()

    def _say_unwritten(self) -> None:
        count, self._unwritten = self._unwritten, 0
        self.write(Entry(what="refused", result=""), "noted", f"{count} not written")
