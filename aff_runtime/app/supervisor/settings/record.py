"""Who changed settings, when and why: into the history, the log and the record of the run."""

from __future__ import annotations

import sys
from dataclasses import dataclass, replace
from pathlib import Path

from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.link.peer import author_of
from aff_runtime.app.link.settings_answer import RETURNED, Version
from aff_runtime.app.supervisor.processes import Processes
from aff_runtime.app.supervisor.settings.history import SiteHistory
from aff_runtime.base.errors import RefusedError
from aff_runtime.base.ports import Clock
from aff_runtime.base.text_digest import text_digest

ANNOUNCED_S = 30.0
"""How long after it was announced a text may be saved as such, s; later it is an edit by hand."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Announced:
    """A text that somebody is about to save, as what and why.

    Attributes
    ----------
    sha256 : of the text, as ``base.text_digest`` gives it.
    verb : what the version will be called: ``kept``, ``undone``.
    until_ns : monotonic time until which the announcement holds, ns.
    """

    sha256: str
    verb: str
    who: str
    why: str
    until_ns: int


class SettingsRecord:
    """Puts versions on record, with who announced them where somebody did.

    Attributes
    ----------
    announced : what somebody is about to save; None: nothing.
    """

    def __init__(
        self, processes: Processes, history: SiteHistory, site: Path, clock: Clock
    ) -> None:
        self._processes, self._history, self._site = processes, history, site
        self._clock = clock
        self.announced: Announced | None = None

    @property
    def versions(self) -> tuple[Version, ...]:
        """The history, oldest first."""
        return self._history.versions

    def announce(self, text: str, verb: str, who: str, why: str) -> None:
        """Take note of what somebody is about to save; it holds for ``ANNOUNCED_S``."""
        until_ns = self._clock.now_ns() + int(ANNOUNCED_S * 1e9)
        sha256 = text_digest(text)
        self.announced = Announced(sha256=sha256, verb=verb, who=who, why=why, until_ns=until_ns)

    def hold(self, record: ParameterRecord) -> None:
        """Keep an announcement whose text was saved in time, and waits for bypass."""
        announced = self.announced
        if (
            announced is not None
            and announced.sha256 == text_digest(record.site_text)
            and announced.until_ns > self._clock.now_ns()
        ):
            self.announced = replace(announced, until_ns=sys.maxsize)

    def see(self, record: ParameterRecord, verb: str) -> None:
        """Put on record what runs now; whatever was announced is used up by it.

        A text that was announced, and in time, gets the verb, the author and the reason of the
        announcement. Any other gets ``verb`` and the owner of the site file, without a reason; one
        that says what the last version says is no new version.
        """
        announced, self.announced = self.announced, None
        sha256 = text_digest(record.site_text)
        if (
            announced is not None
            and announced.sha256 == sha256
            and announced.until_ns > self._clock.now_ns()
        ):
            self.say(announced.verb, record, announced.who, announced.why)
            return
        last = self.versions[-1:]
        if not last or last[0].sha256 != sha256:
            self.say(verb, record, author_of(self._site), "")

    def say(self, verb: str, record: ParameterRecord, who: str, why: str) -> None:
        """Put a version on record, in the history and the log, with the folder that records it."""
        recorder = self._processes.recorder_report()
        run = recorder.folder if recorder is not None else ""
        row = self._history.add(verb, record.site_text, who=who, why=why, run=str(run))
        reason = f": {why}" if why else ""
        text = f"version {row.number} ({row.sha256[:12]}) {verb} by {who}{reason}"
        self._processes.note("SETTINGS", text)

    def numbered(self, number: int) -> Version:
        """Return one version.

        Raises
        ------
        RefusedError
            When there is none of that number.
        """
        for version in self.versions:
            if version.number == number:
                return version
        raise RefusedError(f"no version {number}: {self._what_exists()}")

    def _what_exists(self) -> str:
        """Return which versions there are, and how to see them."""
        if not self.versions:
            return "nothing is on record yet"
        first, last = self.versions[0].number, self.versions[-1].number
        which = f"there are {first} to {last}" if last > first else f"there is {first} alone"
        return f"{which}; `aff-runtime settings history` shows them"

    def before(self, running_sha256: str, number: int) -> Version:
        """Return the version asked for; 0: the last one that stood and is not what runs.

        Parameters
        ----------
        running_sha256 : of the text that runs, as ``base.text_digest`` gives it.
        number : of a version, or 0. One that was only tried, or returned after a try, is taken
            by its number alone.

        Raises
        ------
        RefusedError
            When there is none; or when a try has ended by itself and nothing was done since: who
            asks then may mean that try, and not the version before it.
        """
        if number:
            return self.numbered(number)
        last = self.versions[-1] if self.versions else None
        found = self._last_that_stood(running_sha256)
        if last is not None and last.ended_by_itself:
            raise RefusedError(
                f"the try has ended already ({last.why}), and the former settings run. To go back "
                f"to those before them: `aff-runtime settings undo SITE.yaml {found.number} "
                "--why ...`"
            )
        return found

    def _last_that_stood(self, running_sha256: str) -> Version:
        for version in reversed(self.versions):
            if version.verb not in ("tried", RETURNED) and version.sha256 != running_sha256:
                return version
        raise RefusedError(f"no version before this one: {self._what_exists()}")

    def text(self, version: Version) -> str:
        """Return the text of a version.

        Raises
        ------
        RefusedError
            When it is not there any more.
        """
        if not (text := self._history.text(version)):
            raise RefusedError(f"the text of version {version.number} is not there any more")
        return text
