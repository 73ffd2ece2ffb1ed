"""Every text of a site file that ran, with who, when and why; bounded."""

from __future__ import annotations

import hashlib
import json
import logging
import os
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path

from aff_runtime.app.link.settings_answer import Version
from aff_runtime.base.clock import wall_time_iso
from aff_runtime.base.errors import UNREADABLE
from aff_runtime.base.files import replace_text
from aff_runtime.base.printable import printable
from aff_runtime.base.text_digest import text_digest
from aff_runtime.config.plain_file import read_plain

MOST = 300  # versions
LONGEST_BYTES = 1 << 20  # of a file that is read: `plain_file.MAX_BYTES`
ROWS = "versions.jsonl"
LOG = logging.getLogger("aff_runtime")


def history_folder(site: Path, state: Path) -> Path:
    """Return where a history is kept."""
    return kept_folder(site, state, "settings")


def kept_folder(site: Path, state: Path, purpose: str) -> Path:
    """Return a folder of one site: below ``state``, else in ``learned`` beside the site file.

    ``state`` : the service's own folder; who may not write there keeps it beside the site file.
    """
    root = state if os.access(state, os.W_OK | os.X_OK) else site.absolute().parent / "learned"
    name = hashlib.sha256(os.fsencode(os.path.realpath(site))).hexdigest()[:8]
    return root / purpose / f"{site.stem}-{name}"


class SiteHistory:
    """Versions of one site file: a row each in ``versions.jsonl``, a text each beside it.

    Rows that cannot be read, and what cannot be written, are logged and disturb nothing
    else; a text that cannot be read is empty. The oldest rows go, and with them the texts
    that no row names any more.

    Parameters
    ----------
    now : returns the time as UTC text.
    """

    def __init__(self, folder: Path, now: Callable[[], str] = wall_time_iso) -> None:
        self._folder = folder
        self._now = now
        self._rows = self._read()

    @property
    def versions(self) -> tuple[Version, ...]:
        """The history, oldest first."""
        return tuple(self._rows)

    def add(self, verb: str, text: str, *, who: str, why: str, run: str = "") -> Version:
        """Put a version on record."""
        row = Version(
            number=self._rows[-1].number + 1 if self._rows else 1,
            when=self._now(),
            who=printable(who),
            verb=verb,
            why=printable(why),
            sha256=text_digest(text),
            run=run,
        )
        rows = [*self._rows, row]
        gone, self._rows = rows[:-MOST], rows[-MOST:]
        try:
            self._write(row, text)
            for old in {one.sha256 for one in gone} - {one.sha256 for one in self._rows}:
                self._text_file(old).unlink(missing_ok=True)
        except OSError as error:
            LOG.warning("the settings' history is not kept (%s: %s)", self._folder, error.strerror)
        return row

    def text(self, version: Version) -> str:
        """Return the text of a version; empty when it cannot be read, or is not what ran."""
        try:
            content = read_plain(self._text_file(version.sha256), LONGEST_BYTES).decode("utf-8")
        except (OSError, ValueError):
            return ""
        return content if text_digest(content) == version.sha256 else ""

    def _write(self, version: Version, text: str) -> None:
        self._folder.mkdir(parents=True, exist_ok=True, mode=0o750)
        if self.text(version) != text:  # not there, or damaged
            replace_text(self._text_file(version.sha256), text)
        rows = "".join(f"{json.dumps(asdict(row))}\n" for row in self._rows)
        replace_text(self._folder / ROWS, rows)

    def _text_file(self, sha256: str) -> Path:
        return self._folder / f"{sha256[:16]}.yaml"

    def _read(self) -> list[Version]:
        """Return the rows that are there; one that cannot be read is left out."""
        try:
            text = read_plain(self._folder / ROWS, LONGEST_BYTES).decode("utf-8")
        except FileNotFoundError:
            return []
        except (OSError, ValueError) as error:
            LOG.warning("the settings' history begins anew (%s: %s)", self._folder / ROWS, error)
            return []
        versions = []
        for line in text.splitlines()[-MOST:]:
            try:
                versions.append(Version.from_json(json.loads(line)))
            except UNREADABLE:
                LOG.warning("%s: a row cannot be read and is left out", self._folder / ROWS)
        return sorted(versions, key=lambda row: row.number)
