"""What the commissioner writes into its audit, and into its log."""

from __future__ import annotations

import contextlib
import json
import logging
from collections.abc import Collection, Iterator
from dataclasses import replace
from pathlib import Path

from aff_runtime.app.commission.link.messages import Why
from aff_runtime.app.hand.audit import Audit, AuditEntry
from aff_runtime.app.hand.audit_writer import AuditWriter
from aff_runtime.app.hand.bucket import Bucket
from aff_runtime.app.supervisor.hand.quotas import Shares
from aff_runtime.base.ports import Clock
from aff_runtime.base.printable import text_or
from aff_runtime.base.yaml_section import Section

LOG = logging.getLogger("aff_runtime")

BEGIN = "commissioning: "
"""Of what a line is about; the job and its step come behind."""
_OF_A_PRESS = frozenset(Why)


def unended(path: Path, jobs: Collection[str]) -> list[AuditEntry]:
    """Return what was asked for and has no end on record: its commissioner was killed meanwhile.

    A press that was refused while a job ran is no end of it: such a line has a word of ``Why``,
    and a job that ends refused a sentence.

    Parameters
    ----------
    path : of an audit that holds; the file before it is read too, as one may begin during a job.
    jobs : those that are looked for.
    """
    asked: dict[tuple[str, str], AuditEntry] = {}
    for row in (*_rows(path.with_name(f"{path.name}.1")), *_rows(path)):
        what, result, why, account, role = (
            text_or(row.get(name)) for name in ("what", "result", "why", "account", "role")
        )
        if what.removeprefix(BEGIN).partition(" ")[0] not in jobs:
            continue
        if result == "asked":
            asked[what, account] = AuditEntry(what=what, result=result, account=account, role=role)
        elif result != "refused" or why not in _OF_A_PRESS:
            asked.pop((what, account), None)
    return list(asked.values())


def _rows(path: Path) -> Iterator[Section]:
    """Yield the lines of a file, none where there is no file; what is no object is empty."""
    if not path.exists():
        return
    with path.open("rb") as lines:
        for line in lines:
            with contextlib.suppress(ValueError, RecursionError):
                yield Section.of(json.loads(line))


class AuditLines:
    """Writes lines; of a flood of refusals some, and how many: it pushes no other line out.

    Each user of the socket and each account that it claims has a share of the refusals.
    """

    def __init__(self, audit: Audit, clock: Clock) -> None:
        self._writer = AuditWriter(audit, clock, without="nothing is done")
        self._clock = clock
        self._refusals: dict[int, Shares] = {}

    def write(self, entry: AuditEntry, result: str, why: str = "") -> bool:
        """Write a line; False when it cannot be: then it is in the log, and counted."""
        number = self._writer.write(replace(entry, result=result, why=why))
        by = f" by {entry.account}" if entry.account else ""
        said = f" ({why})" if why else ""
        LOG.info("%s %s%s%s; %s", entry.what, result, by, said, self._writer.kept_as(number))
        return number > 0

    def refuse(self, entry: AuditEntry, uid: int, why: str) -> None:
        """Write a refusal, or count it where its user or account had too many."""
        if uid not in self._refusals:
            in_all = Bucket(self._clock, per_s=0.1, burst=300.0)
            self._refusals[uid] = Shares(
                self._clock, per_s=0.03, burst=60.0, in_all=in_all, kind=" refusals"
            )
        if self._refusals[uid].of(entry.account).take():
            self.write(entry, "refused", why)

    def tend(self) -> None:
        """Say how many lines were lost, and how many refusals not written, once there is room."""
        self._writer.tend()
        self._say_more(at_end=False)

    def close(self) -> None:
        """End it."""
        self._say_more(at_end=True)
        self._writer.close()

    def _say_more(self, *, at_end: bool) -> None:
        for uid, shares in self._refusals.items():
            for why in shares.told(uid, at_end=at_end):
                self.write(AuditEntry(what="more", result=""), "noted", why)
