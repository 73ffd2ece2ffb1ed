"""Follows the site file of a running service: check, diff, apply between two ticks, or say no."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

from aff_runtime.app.check.result import CheckResult
from aff_runtime.app.link.answers import Done, as_answer
from aff_runtime.app.link.messages import ConfigDiffers, Parameters
from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.link.peer import author_of
from aff_runtime.app.link.replies import Reply
from aff_runtime.app.supervisor.file_watch import FileWatch
from aff_runtime.app.supervisor.pending import Pending
from aff_runtime.app.supervisor.processes import Processes
from aff_runtime.app.supervisor.response_exchange import exchanged_responses, exchanged_wire_files
from aff_runtime.app.supervisor.validation import Validation
from aff_runtime.base.runs.site_in_force import IDENTIFIED
from aff_runtime.config.diff import diff_sites, may_apply_while_active
from aff_runtime.config.site_paths import STATE_DIRECTORY

NOT_TAKEN = "the control process did not take the edit; save the file again"


class EditSession:
    """Watches the site file, and the learned responses and files of the wire that it names.

    Parameters
    ----------
    result : check of the file that runs.
    watch : begun before that check read the site file: what was saved since then is an edit.

    Attributes
    ----------
    differs : why the file is not the running configuration; empty when it is.
    findings : warnings about the file whose settings run, as its check said them.
    held : saved files are not checked, as other settings are being tried.
    saved_meanwhile : something was saved while held.
    accepted : called with every record that has become the running one. ``deferred`` : with one
        that waits for bypass.
    is_measuring : whether the result of a probe is to come; what waits for bypass waits for it,
        too, as the control process that fits it would end.
    """

    def __init__(
        self,
        processes: Processes,
        pending: Pending,
        site: Path,
        result: CheckResult,
        state: Path = STATE_DIRECTORY,
        watch: FileWatch | None = None,
    ) -> None:
        self._processes = processes
        self._pending = pending
        self._site = site
        self._state = state
        self._watch = watch or FileWatch([site])
        self._watch.watch(_watched(site, processes.parameters))
        self._check: Validation | None = None
        self._waiting: CheckResult | None = None
        self._handing_over = False
        self.findings = result.findings
        self.differs: tuple[str, ...] = ()
        self.held = self.saved_meanwhile = False
        self.accepted: Callable[[ParameterRecord], None] = _nobody_listens
        self.deferred: Callable[[ParameterRecord], None] = _nobody_listens
        self.is_measuring: Callable[[], bool] = lambda: False

    @property
    def is_busy(self) -> bool:
        """Whether a check or a hand-over is under way."""
        return self._check is not None or self._handing_over

    @property
    def waiting(self) -> str:
        """Text of a saved site file that is taken at the next bypass; empty where none waits."""
        parameters = self._waiting.parameters if self._waiting is not None else None
        return parameters.site_text if parameters is not None else ""

    def step(self) -> None:
        """Look at the file; take the result of a check that has ended."""
        if self._watch.changed():
            if self.held:
                self.saved_meanwhile = True
            else:
                self.look_again()
        if self._check is not None and (result := self._check.result()) is not None:
            self._check = None
            self._judge(result)
        elif self._waiting is not None and not self.held and not self._is_in_use():
            self._judge(self._waiting)

    def _is_in_use(self) -> bool:
        """Whether the control process may not be exchanged: a correction goes out, or it fits."""
        return self._processes.is_live() or self.is_measuring()

    def look_again(self) -> None:
        """Check the file now; a check under way is of an older file."""
        self.close()
        self._waiting = None  # what waits for bypass is of an older file, too
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

    def _judge(self, result: CheckResult) -> None:
        """Apply, restart idle or let wait, whichever the edit allows."""
        self._waiting = None
        parameters, running = result.parameters, self._processes.parameters
        if parameters is None:
            self._refuse(result.findings)
            return
        changes = diff_sites(running.site, parameters.site)
        exchanged = exchanged_responses(running, parameters, self._processes.probed)
        wire = exchanged_wire_files(running, parameters)
        is_edited = running.site_hash != parameters.site_hash
        if changes and is_edited:
            self._processes.note("EDIT", f"{self._site}: {author_of(self._site)}")
        edits = changes if is_edited else [f"{IDENTIFIED}{change}" for change in changes]
        for edit in (*edits, *exchanged, *(f"{what} ({author})" for what, author in wire)):
            self._processes.note("EDIT", str(edit))
        fixed = [change.path for change in changes if not change.may_change_while_active]
        fixed += [what for what, _ in wire]
        waits = [f"{what}: may not change while armed" for what in fixed]
        waits += [exchange.objection for exchange in exchanged if not exchange.is_ours]
        if self._processes.control is None:
            self._accept(parameters, result.findings)  # the next start takes it
        elif waits and self._is_in_use():
            self._waiting = result
            self.deferred(parameters)
            self._refuse(f"{what}; waits for bypass" for what in waits)
        elif may_apply_while_active(changes) and not wire:
            if changes or exchanged:
                revised = self._processes.revised(parameters)
                self.hand_over(revised, findings=result.findings)
            elif parameters.site_text != running.site_text:  # comments and blanks: nothing to send
                self._accept(self._processes.revised(parameters), result.findings)
            else:
                self.differs, self.findings = (), result.findings
        else:
            for finding in result.findings:
                self._processes.note("CONFIG_WARNING", finding)
            self.restart_on(parameters, result.findings)

    def hand_over(
        self,
        parameters: ParameterRecord,
        then: Callable[[Reply], None] | None = None,
        findings: tuple[str, ...] | None = None,
    ) -> None:
        """Send the record to the control process, which takes it between two ticks.

        Parameters
        ----------
        then : gets the reply; without it a refusal is reported as an edit that was not taken.
        findings : warnings about the site file, once it says this; None: it does not.
        """
        self._handing_over = True
        self._pending.ask(
            self._processes.control,
            Parameters(record=parameters.for_control()),
            lambda reply: self._adopted(parameters, findings, reply, then),
            not_sent=NOT_TAKEN,
        )

    def _adopted(
        self,
        parameters: ParameterRecord,
        findings: tuple[str, ...] | None,
        reply: Reply,
        then: Callable[[Reply], None] | None,
    ) -> Done:
        """Take the control process's reply to a new parameter record."""
        self._handing_over = False
        if reply.ok:
            self._accept(parameters, findings)
            self._processes.note_applied()
        elif then is None:
            self._refuse([reply.message or "refused"])
        if then is not None:
            then(reply)
        return as_answer(reply)

    def restart_on(
        self, parameters: ParameterRecord, findings: tuple[str, ...] | None = None
    ) -> None:
        """Fade to zero and go on with a record in a control process that starts idle."""
        self._processes.stop()
        self._accept(parameters, findings)
        self._processes.start()

    def _accept(self, parameters: ParameterRecord, findings: tuple[str, ...] | None) -> None:
        """Take the record as the running one."""
        self.differs = ()
        if findings is not None:
            self.findings = findings
        self._processes.parameters = parameters
        self._watch.watch(_watched(self._site, parameters))
        self.accepted(parameters)

    def _refuse(self, why: Iterable[str]) -> None:
        """Keep what runs and say why."""
        self.differs = tuple(why)
        for line in self.differs:
            self._processes.note("CONFIG_DIFFERS", line)
        if self._processes.control is not None:
            self._processes.control.link.send(ConfigDiffers())


def _nobody_listens(_record: ParameterRecord) -> None:
    """Take no notice."""


def _watched(site: Path, parameters: ParameterRecord) -> list[Path]:
    """Return the site file, the response files it names, and those that describe its wire."""
    wire = [parameters.folder / name for name in parameters.wire_files]
    return [site, *parameters.response_files.values(), *wire]
