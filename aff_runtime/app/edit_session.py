"""Follows the site file of a running service: check, diff, apply between two ticks, or say no."""

from __future__ import annotations

import fnmatch
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Protocol

from aff_runtime.app.edit import Change, changes
from aff_runtime.app.file_watch import FileWatch
from aff_runtime.app.validation import Validation, Verdict


class Service(Protocol):
    """What an edit needs of the supervisor."""

    record: dict[str, Any]

    def note(self, name: str, text: str) -> None:
        """Put a line into the log and the record."""
        ...

    def is_live(self) -> bool:
        """Return whether a correction may be going out."""
        ...

    def start_control(self) -> None:
        """Start the control process."""
        ...

    def stop_control(self) -> None:
        """Stop the control process."""
        ...

    def send_parameters(self, record: dict[str, Any]) -> None:
        """Hand a new parameter record to the control process; ``adopted`` hears of the reply."""
        ...

    def config_differs(self) -> None:
        """Put CONFIG_DIFFERS into the ring's events."""
        ...


class EditSession:
    """Watches the site file and the learned responses it names.

    Attributes
    ----------
    differs : why the file is not the running configuration; empty when it is.
    findings : warnings about the running file.
    """

    def __init__(self, service: Service, site: Path, verdict: Verdict) -> None:
        self._service = service
        self._site = site
        self._watch = FileWatch(_watched(site, verdict.record or {}))
        self._check: Validation | None = None
        self.findings = verdict.findings
        self.differs: tuple[str, ...] = ()

    def step(self) -> None:
        """Look at the file; take the verdict of a check that has ended."""
        if self._watch.changed():
            self.look_again()
        if self._check is not None and (verdict := self._check.verdict()) is not None:
            self._check = None
            self._judge(verdict)

    def look_again(self) -> None:
        """Check the file now; a check under way is of an older file."""
        if self._check is not None:
            self._check.abandon()
        self._check = Validation(self._site)

    def adopted(self, record: dict[str, Any], said: dict[str, Any]) -> None:
        """Take the control process's word on a new parameter record."""
        if said.get("ok"):
            self._service.record = record
            self.differs = ()
            self._watch.watch(_watched(self._site, record))
            self._service.note("CONFIG_APPLIED", record["config_hash"][:12])
        else:
            self._refuse((str(said.get("message", "refused")),))

    def close(self) -> None:
        """End a check under way."""
        if self._check is not None:
            self._check.abandon()
            self._check = None

    def _judge(self, verdict: Verdict) -> None:
        """Apply, restart idle or refuse, whichever the edit allows."""
        record, running = verdict.record, self._service.record
        if record is None:
            self._refuse(verdict.findings)
            return
        self.findings = verdict.findings
        found = list(changes(_comparable(running), _comparable(record)))
        for change in found:
            self._service.note("EDIT", str(change))
        fixed = [change for change in found if not is_live_key(change.path, record["live"])]
        if not found:
            self.differs = ()
            self._service.record = {**record, "config_hash": running["config_hash"]}
        elif not fixed:
            self._service.send_parameters(record)
        elif self._service.is_live():
            self._refuse(
                tuple(f"{c.path}: may not change while armed; `aff-runtime stop`" for c in fixed)
            )
        else:
            self._service.note("CONFIG_APPLIED", "control process restarts idle")
            self.differs = ()
            self._service.stop_control()
            self._service.record = record
            self._watch.watch(_watched(self._site, record))
            self._service.start_control()

    def _refuse(self, why: tuple[str, ...]) -> None:
        """Keep what runs and say why."""
        self.differs = why
        for line in why:
            self._service.note("CONFIG_DIFFERS", line)
        self._service.config_differs()


def is_live_key(path: str, live: Iterable[str]) -> bool:
    """Return whether the key at ``path`` may change while the correction is going out.

    ``live`` holds patterns with ``*`` for any name and ``[*]`` for any position.
    """
    plain = re.sub(r"\[\d+\]", "[*]", path)
    return any(
        fnmatch.fnmatchcase(plain, pattern.replace("[*]", "[[][*]]"))
        for pattern in live
    )


def _comparable(record: dict[str, Any]) -> dict[str, Any]:
    """Return the part of a parameter record that an edit can change."""
    return {**record["site"], "responses": record["responses"]}


def _watched(site: Path, record: dict[str, Any]) -> list[Path]:
    """Return the site file and the response files it names."""
    return [site, *(Path(path) for path in record.get("response_files", {}).values())]
