"""Requests about settings: compare, try, keep, undo, history.

The service never writes the site file: whoever may write it saves the text that is handed out,
and the service takes it for what it was announced as. Until it is saved nothing is kept.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from aff_runtime.app.check.result import CheckResult
from aff_runtime.app.hand.may import (
    OF_SETTINGS,
    WORDS,
    Action,
    Circumstances,
    Code,
    against_settings,
)
from aff_runtime.app.link.answers import Done
from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.link.replies import Reply
from aff_runtime.app.link.request_socket import Asked
from aff_runtime.app.link.settings_answer import RETURNED, SAVED_MEANWHILE, SettingsAnswer, Version
from aff_runtime.app.link.settings_request import SettingsRequest
from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.app.supervisor.edit_session import EditSession
from aff_runtime.app.supervisor.processes import Processes
from aff_runtime.app.supervisor.response_exchange import exchanged_responses, exchanged_wire_files
from aff_runtime.app.supervisor.run_options import RunOptions
from aff_runtime.app.supervisor.settings.history import SiteHistory, digest, history_folder
from aff_runtime.app.supervisor.settings.listening import hear
from aff_runtime.app.supervisor.settings.record import SettingsRecord
from aff_runtime.app.supervisor.settings.ripple_rise import RippleRise
from aff_runtime.app.supervisor.settings.settings_try import Plan, SettingsTry
from aff_runtime.app.supervisor.validation import Validation
from aff_runtime.base.errors import ConfigError, RefusedError
from aff_runtime.base.ports import Clock
from aff_runtime.config.diff import Change, diff_sites
from aff_runtime.config.plain_file import read_plain

Checked = Callable[[Asked, CheckResult], None]
BEING_CHECKED = "other settings are being checked; try again"
TAKEN_BACK = "the correction was taken back meanwhile; look again"
ANOTHER_TRY = "other settings are being tried than those that you saw; look again"


class SettingsDesk:
    """Does what is asked about settings, and looks after a try.

    Parameters
    ----------
    edits : follows the site file; hands settings over.
    stands : returns the state of the service by which requests are judged, but for a try.
    """

    def __init__(
        self,
        processes: Processes,
        edits: EditSession,
        options: RunOptions,
        clock: Clock,
        stands: Callable[[], Circumstances],
    ) -> None:
        self._stands = stands
        self._processes, self._edits, self._clock = processes, edits, clock
        self._site, self._state = options.site.absolute(), options.state_directory
        history = SiteHistory(history_folder(options.site, options.state_directory))
        self._record = SettingsRecord(processes, history, self._site, clock)
        self._ripple = RippleRise()
        self._check: tuple[Asked, Validation, Checked] | None = None
        self._tried: SettingsTry | None = None
        self._undo_asked: list[Asked] = []
        edits.accepted = self._accepted
        self._record.see(processes.parameters, "started")

    @property
    def trying(self) -> str:
        """How a try stands, in words; empty without one."""
        tried = self._tried
        if tried is None or tried.is_over:
            return ""
        how = f"{tried.left_s:.0f} s left, then the former return" if tried.runs else "not yet"
        return (
            f"settings {digest(tried.plan.parameters.site_text)[:12]} by {tried.plan.who}: {how}"
        )

    @property
    def tried(self) -> str:
        """Sha256 of the text that is tried; empty without a try."""
        tried = self._tried
        if tried is None or tried.is_over:
            return ""
        return digest(tried.plan.parameters.site_text)

    def refuse_while_trying(self) -> None:
        """Refuse what would mix with a try.

        Raises
        ------
        RefusedError
            When settings are being tried or checked for it.
        """
        if self._is_trying:
            raise RefusedError(WORDS[Code.TRYING])

    def do(self, asked: Asked) -> None:
        """Do what a request asks, or say why not; answers now or later."""
        request = asked.request.settings or SettingsRequest(act="state")
        self._refuse_what_may_not(request.act)
        match request.act:
            case "diff":
                self._begin_check(asked, request.text, self._tell_diff)
            case "try":
                self._check_file()
                base = self._check_base(request)
                self._make_room()
                was_live = self._processes.is_live()
                self._begin_check(asked, request.text, partial(self._try, base, was_live))
            case "keep":
                self._keep(asked, request)
            case "undo":
                self._undo(asked, request)
            case "history":
                self._tell_history(asked, request)
            case _:
                asked.answer(self._answer())

    def _refuse_what_may_not(self, act: str, *, trying: bool | None = None) -> None:
        if act in OF_SETTINGS:
            is_trying = self._is_trying if trying is None else trying
            now = replace(self._stands(), trying=is_trying)
            for reason in against_settings(Action(act), now):
                raise RefusedError(reason.text)

    @property
    def _is_trying(self) -> bool:
        """Whether a try runs or is checked for; a look at a difference is none."""
        return self._tried is not None or (self._check is not None and self._is_for_try)

    @property
    def _is_for_try(self) -> bool:
        request = self._check[0].request.settings if self._check is not None else None
        return request is not None and request.act == "try"

    def step(self, latest: TickRow | None) -> None:
        """Do what time brings: a check that has ended, ripple, the end of a try."""
        hear(self._processes.ring, self._processes.parameters.site, self._ripple)
        if self._check is not None:
            asked, check, then = self._check
            if (result := check.result()) is not None:
                self._check = None
                self._judge(asked, result, then)
        if (tried := self._tried) is not None:
            if not self._was_saved(tried):
                tried.step(latest)
            if tried.is_over:
                self._tried = None

    def control_died(self) -> None:
        """Have the next control process start on the former settings."""
        if self._tried is not None:
            self._tried.control_died()
            self._tried = None

    def close(self) -> None:
        """End with the service; its next start takes the former settings, which the file says."""
        if self._check is not None:
            asked, check, _ = self._check
            check.abandon()
            asked.answer(Done(ok=False, message="the service stops"))
        if self._tried is not None:
            self._tried.is_over = True
            self._ended("the service stops")

    # --- checks -------------------------------------------------------------------------------

    def _make_room(self) -> None:
        """End a look at a difference: nobody who looks holds up a try."""
        if self._check is not None and not self._is_for_try:
            (asked, check, _), self._check = self._check, None
            check.abandon()
            asked.answer(Done(ok=False, message=BEING_CHECKED))

    def _begin_check(self, asked: Asked, text: str, then: Checked) -> None:
        if self._check is not None:
            raise RefusedError(BEING_CHECKED)
        try:
            check = Validation(self._site, self._state, text=text)
        except OSError as error:
            raise RefusedError(f"cannot be checked now: {error.strerror}; try again") from None
        self._check = (asked, check, then)

    def _judge(self, asked: Asked, result: CheckResult, then: Checked) -> None:
        try:
            result.checked()
            then(asked, result)
        except (ConfigError, RefusedError) as error:
            asked.refuse(error)

    def _changes(self, parameters: ParameterRecord) -> tuple[Change, ...]:
        return diff_sites(self._processes.parameters.site, parameters.site)

    def _new_remarks(self, result: CheckResult) -> tuple[str, ...]:
        """Return the warnings that the running file did not have when the service began."""
        known = {finding.partition("  ")[2] for finding in self._edits.findings}
        return tuple(one for one in result.findings if one.partition("  ")[2] not in known)

    def _tell_diff(self, asked: Asked, result: CheckResult) -> None:
        changes = self._changes(result.checked())
        asked.answer(
            self._answer(changes=tuple(map(str, changes)), remarks=self._new_remarks(result))
        )

    # --- try, keep, undo ----------------------------------------------------------------------

    def _try(self, base: str, was_live: bool, asked: Asked, result: CheckResult) -> None:
        """Begin a try; ``base``, ``was_live``: what ran and went out when its check began."""
        parameters, request = result.checked(), asked.request.settings
        assert request is not None
        self._refuse_what_may_not("try", trying=False)  # a check takes a second
        if was_live and not self._processes.is_live():
            raise RefusedError(TAKEN_BACK)
        if digest(self._processes.parameters.site_text) != base:
            raise RefusedError(SAVED_MEANWHILE)
        changes = self._changes(parameters)
        if not changes:
            raise RefusedError("nothing differs from what runs")
        waits = [str(change) for change in changes if not change.may_change_while_active]
        running = self._processes.parameters
        exchanged = exchanged_responses(running, parameters, self._processes.probed)
        waits += [f"{one} (changed on the disk as well)" for one in exchanged]
        waits += [what for what, _ in exchanged_wire_files(running, parameters)]
        if waits:
            raise RefusedError(
                "\n".join([*waits, "to be saved in the site file: no try can take it back"])
            )
        if self._processes.control is None or self._edits.is_busy:
            raise RefusedError("the service is not ready for other settings; try again")
        plan = Plan(
            parameters=parameters,
            seconds=request.seconds,
            who=asked.who,
            why=request.why,
            findings=result.findings,
        )
        tried = SettingsTry(
            plan, self._processes, self._edits, self._clock, self._ripple, ended=self._ended
        )
        self._tried = tried
        answer = self._answer(changes=tuple(map(str, changes)), remarks=self._new_remarks(result))

        def taken(reply: Reply) -> None:
            if not reply.ok:
                self._tried = None
                asked.answer(Done(ok=False, message=reply.message, exit_code=4))
                self._tell_undone()
                return
            self._record.say("tried", parameters, plan.who, f"{plan.seconds:g} s: {plan.why}")
            for change in changes:
                self._processes.note("SETTINGS", str(change))
            asked.answer(answer)

        tried.begin(taken)

    def _refuse_another(self, request: SettingsRequest) -> None:
        """Refuse what is about one try, and that one does not run."""
        if request.tried and request.tried != self.tried:
            raise RefusedError(ANOTHER_TRY if self.tried else WORDS[Code.NO_TRY])

    def _keep(self, asked: Asked, request: SettingsRequest) -> None:
        self._refuse_another(request)
        tried = self._tried
        if tried is None or not tried.runs:
            raise RefusedError(WORDS[Code.NO_TRY])
        self._check_file(tried.former.site_text)
        tried.grant()
        text, former = tried.plan.parameters.site_text, tried.former.site_text
        self._record.announce(text, "kept", asked.who, request.why)
        asked.answer(self._answer(text=text, replaces=digest(former)))

    def _undo(self, asked: Asked, request: SettingsRequest) -> None:
        self._refuse_another(request)
        tried = self._tried
        if tried is not None:
            if request.version:
                raise RefusedError("a try runs: end it first, by `undo` without a version")
            self._record.announced = None
            self._undo_asked.append(asked)
            tried.end(f"undone by {asked.who}: {request.why}")
            return
        self.refuse_while_trying()
        self._check_file()
        self._check_base(request)
        running = self._processes.parameters.site_text
        version = self._record.before(digest(running), request.version)
        text = self._record.text(version)
        why = f"{request.why} (version {version.number})"
        self._record.announce(text, "undone", asked.who, why)
        asked.answer(self._answer(text=text, replaces=digest(running)))

    def _check_file(self, expected: str | None = None) -> None:
        """Refuse while the site file says something else than what runs, or ran."""
        wanted = self._processes.parameters.site_text if expected is None else expected
        if self._file_text() != wanted:
            raise RefusedError(
                f"{self._site} is not what runs: somebody has saved it; see `aff-runtime status`"
            )

    def _check_base(self, request: SettingsRequest) -> str:
        """Refuse what was decided on other settings than those that run; return their digest."""
        running = digest(self._processes.parameters.site_text)
        if request.base not in ("", running):
            raise RefusedError(SAVED_MEANWHILE)
        return running

    def _file_text(self) -> str:
        try:
            return read_plain(self._site).decode("utf-8")
        except (OSError, ValueError):
            return ""

    def _was_saved(self, tried: SettingsTry) -> bool:
        """Take note that the file says what is tried, as announced; then it is kept."""
        announced = self._record.announced
        if announced is None or not tried.runs or not self._edits.saved_meanwhile:
            return False
        if announced.until_ns <= self._clock.now_ns():
            return False
        parameters = tried.plan.parameters
        if (
            announced.sha256 != digest(parameters.site_text)
            or self._file_text() != parameters.site_text
        ):
            return False
        tried.kept()
        self._record.see(parameters, announced.verb)
        return True

    def _ended(self, why: str) -> None:
        """Put on record that the former settings run again; tell those who wanted that."""
        self._record.announced = None
        self._record.say(RETURNED, self._processes.parameters, "the service", why)
        self._tell_undone()

    def _tell_undone(self) -> None:
        """Tell those who asked for the former settings that they run."""
        asked, self._undo_asked = self._undo_asked, []
        for one in asked:
            one.answer(self._answer())

    # --- record -------------------------------------------------------------------------------

    def _accepted(self, parameters: ParameterRecord) -> None:
        """Put on record what has become the running settings by way of the site file."""
        if self._tried is None and parameters.site_text:
            self._record.see(parameters, "edited")

    def _tell_history(self, asked: Asked, request: SettingsRequest) -> None:
        if not request.version:
            asked.answer(self._answer(versions=self._record.versions))
            return
        version = self._record.numbered(request.version)
        asked.answer(self._answer(versions=(version,), text=self._record.text(version)))

    def _answer(
        self,
        *,
        changes: tuple[str, ...] = (),
        remarks: tuple[str, ...] = (),
        text: str = "",
        replaces: str = "",
        versions: tuple[Version, ...] = (),
    ) -> SettingsAnswer:
        return SettingsAnswer(
            site=str(self._site),
            running=digest(self._processes.parameters.site_text),
            trying=self.trying,
            changes=changes,
            remarks=remarks,
            text=text,
            replaces=replaces,
            versions=versions,
        )
