"""Follows the site file of a running service: check, diff, apply between two ticks, or say no."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from aff_runtime.app.link.messages import ConfigDiffers, Parameters, Reply
from aff_runtime.app.link.peer import author_of
from aff_runtime.app.supervisor.file_watch import FileWatch
from aff_runtime.app.supervisor.pending import Pending, as_answer
from aff_runtime.app.supervisor.processes import Processes
from aff_runtime.app.supervisor.response_exchange import exchanged_responses
from aff_runtime.app.supervisor.validation import Validation, Verdict
from aff_runtime.app.wiring.assemble import site_of
from aff_runtime.app.wiring.parameter_record import for_control
from aff_runtime.config.diff import diff_sites, may_apply_while_active
from aff_runtime.config.site_paths import STATE_DIRECTORY

ADOPT_PATIENCE_S = 2.0


class EditSession:
    """Watches the site file and the learned responses it names.

    Attributes
    ----------
    differs : why the file is not the running configuration; empty when it is.
    findings : warnings about the running file.
    """

    def __init__(
        self,
        processes: Processes,
        pending: Pending,
        site: Path,
        verdict: Verdict,
        state: Path = STATE_DIRECTORY,
    ) -> None:
        self._processes = processes
        self._pending = pending
        self._site = site
        self._state = state
        self._watch = FileWatch(_watched(site, processes.record))
        self._check: Validation | None = None
        self._waiting: Verdict | None = None
        self._handing_over = False
        self.findings = verdict.findings
        self.differs: tuple[str, ...] = ()

    @property
    def is_busy(self) -> bool:
        """Whether a check or a hand-over is under way."""
        return self._check is not None or self._handing_over

    def step(self) -> None:
        """Look at the file; take the verdict of a check that has ended."""
        if self._watch.changed():
            self.look_again()
        if self._check is not None and (verdict := self._check.verdict()) is not None:
            self._check = None
            self._judge(verdict)
        elif self._waiting is not None and not self._processes.is_live():
            self._judge(self._waiting)

    def look_again(self) -> None:
        """Check the file now; a check under way is of an older file."""
        self.close()
        try:
            self._check = Validation(self._site, self._state)
        except OSError as error:
            self._refuse(
                [f"{self._site}:1:1  cannot be checked now: {error.strerror}; save again"]
            )

    def close(self) -> None:
        """End a check under way."""
        if self._check is not None:
            self._check.abandon()
            self._check = None

    def _judge(self, verdict: Verdict) -> None:
        """Apply, restart idle or let wait, whichever the edit allows."""
        self._waiting = None
        record, running = verdict.record, self._processes.record
        if record is None:
            self._refuse(verdict.findings)
            return
        found = diff_sites(site_of(running), site_of(record))
        exchanged = exchanged_responses(running, record, self._processes.probed)
        if found:
            self._processes.note("EDIT", f"{self._site}: {author_of(self._site)}")
        for edit in (*found, *exchanged):
            self._processes.note("EDIT", str(edit))
        fixed = [change.path for change in found if not change.may_change_while_active]
        waits = [f"{path}: may not change while armed" for path in fixed]
        waits += [exchange.objection for exchange in exchanged if not exchange.is_ours]
        if self._processes.control is None:
            self._accept(record)  # the next start takes it
        elif waits and self._processes.is_live():
            self._waiting = verdict
            self._refuse(f"{what}; waits for bypass" for what in waits)
        elif may_apply_while_active(found):
            if found or exchanged:
                self._hand_over(self._processes.revised(record))
            self.differs = ()
        else:
            self._processes.stop()
            self._accept(record)
            for finding in verdict.findings:
                self._processes.note("CONFIG_WARNING", finding)
            self._processes.start()

    def _hand_over(self, record: dict[str, Any]) -> None:
        """Send the record to the control process, which takes it between two ticks."""
        self._handing_over = True
        ident = self._pending.expect(
            None, lambda reply: self._adopted(record, reply), ADOPT_PATIENCE_S
        )
        control = self._processes.control
        message = Parameters(id=ident, record=for_control(record))
        if control is None or not control.link.send(message):
            text = "the control process did not take the edit; save the file again"
            self._pending.resolve(Reply(id=ident, ok=False, message=text))

    def _adopted(self, record: dict[str, Any], reply: Reply) -> dict[str, Any]:
        """Take the control process's word on a new parameter record."""
        self._handing_over = False
        if reply.ok:
            self._accept(record)
            self._processes.note("CONFIG_APPLIED", self._processes.revision_words())
        else:
            self._refuse([reply.message or "refused"])
        return as_answer(reply)

    def _accept(self, record: dict[str, Any]) -> None:
        """Take the record as the running one."""
        self.differs = ()
        self._processes.record = record
        self._watch.watch(_watched(self._site, record))

    def _refuse(self, why: Iterable[str]) -> None:
        """Keep what runs and say why."""
        self.differs = tuple(why)
        for line in self.differs:
            self._processes.note("CONFIG_DIFFERS", line)
        if self._processes.control is not None:
            self._processes.control.link.send(ConfigDiffers())


def _watched(site: Path, record: dict[str, Any]) -> list[Path]:
    """Return the site file and the response files it names."""
    return [site, *(Path(path) for path in record.get("response_files", {}).values())]
