"""Requests about settings: compare, try, keep, save, undo, history.

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
from aff_runtime.app.link.settings_answer import (
    RETURNED,
    SAVED_MEANWHILE,
    UNDONE_BY,
    SettingsAnswer,
    Version,
)
from aff_runtime.app.link.settings_request import SettingsRequest
from aff_runtime.app.report.status_answer import NOT_SAID
from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.app.supervisor.edit_session import EditSession
from aff_runtime.app.supervisor.processes import STOPS, Processes
from aff_runtime.app.supervisor.run_options import RunOptions
from aff_runtime.app.supervisor.settings.history import SiteHistory, history_folder
from aff_runtime.app.supervisor.settings.listening import hear
from aff_runtime.app.supervisor.settings.record import SettingsRecord
from aff_runtime.app.supervisor.settings.ripple_rise import RippleRise
from aff_runtime.app.supervisor.settings.settings_try import SettingsTry, TryRequest
from aff_runtime.app.supervisor.settings.text_checks import TextChecks
from aff_runtime.app.supervisor.settings.waits import what_waits
from aff_runtime.app.supervisor.validation import Validation
from aff_runtime.base.errors import RefusedError
from aff_runtime.base.ports import Clock
from aff_runtime.base.text_digest import text_digest
from aff_runtime.config.diff import Change, diff_sites
from aff_runtime.config.plain_file import read_plain

TAKEN_BACK = "the correction was taken back meanwhile; look again"
RETURN_ALREADY = "the former settings return already"
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
        self._checks = TextChecks(lambda text: Validation(self._site, self._state, text=text))
        self._tried: SettingsTry | None = None
        self._undo_asked: list[Asked] = []
        edits.accepted, edits.deferred = self._accepted, self._record.hold
        self._record.see(processes.parameters, "started")

    @property
    def trying(self) -> str:
        """Which settings are tried, and by whom; empty without a try."""
        tried = self._tried
        if tried is None or tried.is_over:
            return ""
        return f"settings {text_digest(tried.plan.parameters.site_text)[:12]} by {tried.plan.who}"

    @property
    def trying_left_s(self) -> float:
        """Seconds until the former settings return; `NOT_SAID` where none are counted."""
        tried = self._tried
        return tried.left_s if tried is not None and tried.runs else NOT_SAID

    @property
    def tried(self) -> str:
        """Sha256 of the text that is tried; empty without a try."""
        tried = self._tried
        if tried is None or tried.is_over:
            return ""
        return text_digest(tried.plan.parameters.site_text)

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
                self._checks.begin(asked, request.text, self._tell_diff)
            case "try":
                self._check_file()
                base = self._check_base(request)
                self._checks.make_room()
                was_live = self._processes.is_live()
                self._checks.begin(asked, request.text, partial(self._try, base, was_live))
            case "save":
                base = self._check_saved(request)
                self._checks.make_room()
                self._checks.begin(asked, request.text, partial(self._save, base))
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
        return self._tried is not None or self._checks.is_for_change

    def step(self, latest: TickRow | None) -> None:
        """Do what time brings: a check that has ended, ripple, the end of a try."""
        hear(self._processes.ring, self._processes.parameters.site, self._ripple)
        self._checks.step()
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
        self._checks.close()
        if self._tried is not None:
            self._tried.is_over = True
            self._ended(STOPS)

    # --- checks -------------------------------------------------------------------------------

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
        if text_digest(self._processes.parameters.site_text) != base:
            raise RefusedError(SAVED_MEANWHILE)
        changes = self._changes(parameters)
        if not changes:
            raise RefusedError("nothing differs from what runs")
        if waits := what_waits(self._processes, parameters, changes):
            raise RefusedError(
                "\n".join([*waits, "to be saved in the site file: no try can take it back"])
            )
        if self._processes.control is None or self._edits.is_busy:
            raise RefusedError("the service is not ready for other settings; try again")
        plan = TryRequest(
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
            if not reply.ok or tried.is_over:  # or it was taken by one that ends with the service
                self._tried = None
                message = reply.message or STOPS
                asked.answer(Done(ok=False, message=message, exit_code=4))
                self._tell_undone(message)
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
        if tried.returning:  # perhaps since ripple rose under them
            raise RefusedError(f"{RETURN_ALREADY} ({tried.returning})")
        self._check_file(tried.former.site_text)
        tried.grant()
        text, former = tried.plan.parameters.site_text, tried.former.site_text
        self._record.announce(text, "kept", asked.who, request.why)
        asked.answer(self._answer(text=text, replaces=text_digest(former)))

    def _save(self, base: str, asked: Asked, result: CheckResult) -> None:
        """Hand a text out that runs as any edit does, what may not change at once after bypass."""
        parameters, request = result.checked(), asked.request.settings
        assert request is not None
        self._refuse_what_may_not("save", trying=False)  # a check takes a second
        if self._check_saved(request) != base:
            raise RefusedError(SAVED_MEANWHILE)
        if text_digest(parameters.site_text) == base:
            raise RefusedError("nothing differs from what is saved")
        changes = tuple(map(str, self._changes(parameters)))
        self._record.announce(parameters.site_text, "edited", asked.who, request.why)
        remarks = self._new_remarks(result)
        said = self._answer(changes=changes, remarks=remarks, text=parameters.site_text)
        asked.answer(replace(said, replaces=base))

    def _undo(self, asked: Asked, request: SettingsRequest) -> None:
        self._refuse_another(request)
        tried = self._tried
        if tried is not None and not tried.is_over:
            if request.version:
                raise RefusedError("a try runs: end it first, by `undo` without a version")
            self._record.announced = None
            self._undo_asked.append(asked)
            tried.end(f"{UNDONE_BY}{asked.who}: {request.why}")
            return
        self._tried = None
        self.refuse_while_trying()
        saved = self._check_saved(replace(request, base=""))
        self._check_base(request)
        running = self._processes.parameters.site_text
        if saved != text_digest(running) and not request.version:
            text, why = running, f"{request.why} (what waited for bypass is taken back)"
        else:
            version = self._record.before(text_digest(running), request.version)
            text, why = self._record.text(version), f"{request.why} (version {version.number})"
        self._record.announce(text, "undone", asked.who, why)
        asked.answer(self._answer(text=text, replaces=saved))

    def _check_file(self, expected: str | None = None) -> None:
        """Refuse while the site file says something else than what runs, or ran."""
        wanted = self._processes.parameters.site_text if expected is None else expected
        if self._file_text() != wanted:
            raise RefusedError(
                f"{self._site} is not what runs: somebody has saved it; see `aff-runtime status`"
            )

    def _check_saved(self, request: SettingsRequest) -> str:
        """Return the digest of what the site file says: what runs, or what waits for bypass.

        Raises
        ------
        RefusedError
            It says something else, or a request was decided on another text.
        """
        saved = self._edits.waiting or self._processes.parameters.site_text
        self._check_file(saved)
        if request.base not in ("", text_digest(saved)):
            raise RefusedError(SAVED_MEANWHILE)
        return text_digest(saved)

    def _check_base(self, request: SettingsRequest) -> str:
        """Refuse what was decided on other settings than those that run; return their digest."""
        running = text_digest(self._processes.parameters.site_text)
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
        if tried.returning:  # the file is an edit then, as any other
            return False
        if announced.until_ns <= self._clock.now_ns():
            return False
        parameters = tried.plan.parameters
        if (
            announced.sha256 != text_digest(parameters.site_text)
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
        self._tell_undone(why)

    def _tell_undone(self, why: str) -> None:
        """Tell those who asked for the former settings that they run, and what ended the try."""
        asked, self._undo_asked = self._undo_asked, []
        for one in asked:
            one.answer(self._answer(remarks=(why,)))

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
            running=text_digest(self._processes.parameters.site_text),
            trying=self.trying,
            waiting=text_digest(self._edits.waiting) if self._edits.waiting else "",
            changes=changes,
            remarks=remarks,
            text=text,
            replaces=replaces,
            versions=versions,
        )
