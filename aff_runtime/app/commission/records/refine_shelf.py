"""Where refinements are kept: a folder each, the oldest go."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path

from pydantic import TypeAdapter

from aff_runtime.app.commission.records.refine_program import FILE_BYTES
from aff_runtime.app.commission.views.of_refining import AskedOf, LackingView, RefinedRow
from aff_runtime.app.supervisor.settings.history import kept_folder
from aff_runtime.base.errors import RefusedError
from aff_runtime.base.files import replace_text
from aff_runtime.base.printable import printable
from aff_runtime.base.refinement import KINDS, LACKING, SUMMARY, Lacking, Summary
from aff_runtime.config.plain_file import read_plain

MOST_REFINEMENTS = 20
FREE_BYTES = 500_000_000
"""Disk that is left to the records of the service."""
ASKED_FILE, FAILED, LOG = "asked.json", "failed.txt", "log.txt"
SITE_AT_BEGIN = "site.yaml"
"""The site file as it was when the refinement began: a proposal changes that text."""
OUT = "out"
"""Folder that refine writes: its page, its verdict, and the site file that it proposes."""
PROPOSED, PAGE_FILE = "site_proposed.yaml", "report.html"
LOOKED = "lacking"
"""Folder of the last look at what windows lack, before any work on them."""
FAILURE_BYTES = 4000  # of a sentence why there is no verdict: 900 characters in UTF-8
_ASKED, _SUMMARY, _LACKING = TypeAdapter(AskedOf), TypeAdapter(Summary), TypeAdapter(Lacking)


class Shelf:
    """The refinements of one site.

    Parameters
    ----------
    site : its file. ``state`` : folder of what the service learns.
    """

    def __init__(self, site: Path, state: Path) -> None:
        self.folder = kept_folder(site, state, "refined")

    def begin(self, asked: AskedOf, site_text: str) -> Path:
        """Return the folder of a new refinement; the oldest ones beyond ``MOST_REFINEMENTS`` go.

        Raises
        ------
        RefusedError
            It cannot be made, or the disk has too little room.
        """
        numbers = self.numbers()
        folder = self._put(_name(max(numbers, default=0) + 1), asked, site_text)
        for number in numbers[: max(0, len(numbers) + 1 - MOST_REFINEMENTS)]:
            shutil.rmtree(self.folder / _name(number), ignore_errors=True)
        return folder

    def look(self, asked: AskedOf) -> Path:
        """Return the folder of a look at what records lack; the one before goes.

        Raises
        ------
        RefusedError
            It cannot be made, or the disk has too little room.
        """
        shutil.rmtree(self.folder / LOOKED, ignore_errors=True)
        return self._put(LOOKED, asked, "")

    def numbers(self) -> list[int]:
        """Return the numbers of what is kept, oldest first."""
        if not self.folder.is_dir():
            return []
        return sorted(int(one.name) for one in self.folder.iterdir() if one.name.isdecimal())

    def of(self, number: int) -> Path:
        """Return the folder of a refinement.

        Raises
        ------
        RefusedError
            There is none of that number.
        """
        found = self.folder / _name(number)
        if not (found / ASKED_FILE).is_file():
            raise RefusedError(f"no refinement {number} is kept; the last {MOST_REFINEMENTS} are")
        return found

    def rows(self) -> Iterator[RefinedRow]:
        """Yield what is kept, newest first; what cannot be read is left out."""
        for number in reversed(self.numbers()):
            try:
                yield self.row(number)
            except (OSError, ValueError, RefusedError):
                continue

    def row(self, number: int) -> RefinedRow:
        """Return one refinement in short.

        Raises
        ------
        RefusedError, OSError, ValueError
            There is none, or it cannot be read.
        """
        folder = self.of(number)
        found = summary_in(folder)
        kind, text = (found.kind, found.headline) if found is not None else ("", failure(folder))
        return RefinedRow(number=number, asked=asked_in(folder), kind=kind, text=text)

    def lacking(self) -> LackingView | None:
        """Return what the records lacked that were looked at last; None where none were."""
        folder = self.folder / LOOKED
        try:
            found = _LACKING.validate_json(read_plain(folder / OUT / LACKING, FILE_BYTES))
            return LackingView(asked=asked_in(folder), found=found)
        except (OSError, ValueError):
            return None

    def _put(self, name: str, asked: AskedOf, site_text: str) -> Path:
        folder = self.folder / name
        try:
            folder.mkdir(parents=True)
            if shutil.disk_usage(folder).free < FREE_BYTES:
                folder.rmdir()
                raise RefusedError(
                    f"{self.folder}: less than {FREE_BYTES / 1e6:g} MB of the disk are free; "
                    "they are left to the records of the service"
                )
            replace_text(folder / ASKED_FILE, json.dumps(asdict(asked)))
            replace_text(folder / SITE_AT_BEGIN, site_text)
        except OSError as error:
            raise RefusedError(f"{folder}: cannot be written ({error.strerror})") from None
        return folder


def asked_in(folder: Path) -> AskedOf:
    """Return what a refinement was asked for.

    Raises
    ------
    OSError, ValueError
        It cannot be read.
    """
    return _ASKED.validate_json(read_plain(folder / ASKED_FILE, FILE_BYTES))


def summary_in(folder: Path) -> Summary | None:
    """Return the verdict in words, None where there is none that this release can read."""
    try:
        found = _SUMMARY.validate_json(read_plain(folder / OUT / SUMMARY, FILE_BYTES))
    except (OSError, ValueError):
        return None
    return found if found.kind in KINDS else None


def failure(folder: Path) -> str:
    """Return why a refinement has no verdict; empty where it runs, or was stopped."""
    try:
        return printable(read_plain(folder / FAILED, FAILURE_BYTES).decode("utf-8"), FAILURE_BYTES)
    except (OSError, ValueError):
        return ""


def text_in(folder: Path, name: str) -> str:
    """Return a text of a refinement, empty where there is none.

    Raises
    ------
    RefusedError
        It cannot be read.
    """
    try:
        return read_plain(folder / name, FILE_BYTES).decode("utf-8")
    except FileNotFoundError:
        return ""
    except (OSError, ValueError) as error:
        raise RefusedError(f"{folder / name}: cannot be read ({error})") from None


def _name(number: int) -> str:
    return f"{number:04d}"
