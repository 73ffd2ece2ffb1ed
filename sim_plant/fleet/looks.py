"""What a fleet has: a line file per line, and its records in the order in which they were made."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, date, datetime
from pathlib import Path

from aff_runtime.base.errors import PlantError

RECORD_ENDS = (".csv", ".csv.gz", ".txt", ".parquet", ".mf4")
DATE = re.compile(r"(?<!\d)(20\d\d)-?(\d\d)-?(\d\d)(?:\d{6})?(?!\d)")
"""A day, with or without the time after it: no part of a longer number."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Look:
    """One look at a line: a record to fit and one to judge on.

    Attributes
    ----------
    line : name of the line, that of its file.
    file : its declaration.
    fitted, held : records, files or run folders; ``held`` is the later one.
    recorded : day of the first: from its name (2026-11-22) if that is one, else from when it
        was written.
    """

    line: str
    file: Path
    fitted: Path
    held: Path
    recorded: str

    def __str__(self) -> str:
        return f"{self.line}, {self.fitted.name}"

    @property
    def key(self) -> str:
        """Name of its row: another line file or another record is another look."""
        digest = hashlib.sha256(self.file.read_bytes())
        for record in (self.fitted, self.held):
            digest.update(f"{record.name} {_stamp(record)}".encode())
        return f"{self.line}-{digest.hexdigest()[:16]}"


def looks_in(lines: Path, runs: Path) -> list[Look]:
    """Return every look that two folders hold.

    ``lines`` has a file NAME.yaml per line, ``runs`` a folder NAME per line with its records, by
    name in the order of time. Each two of them are a look; one left over waits for the next.

    Raises
    ------
    PlantError
        When a folder cannot be read, there is no line, or a folder of records has no line.
    """
    files = {path.stem: path for path in sorted(_inside(lines)) if path.suffix == ".yaml"}
    if not files:
        raise PlantError(f"{lines}: no line file NAME.yaml in it")
    folders = {path.name: path for path in sorted(_inside(runs)) if path.is_dir()}
    strangers = sorted(folders.keys() - files.keys())
    if strangers:
        raise PlantError(
            f"{runs}: the folder {strangers[0]} has no line file; put {strangers[0]}.yaml into "
            f"{lines}, or take the folder away"
        )
    return [look for name, folder in folders.items() for look in _looks(name, files[name], folder)]


def _looks(name: str, file: Path, folder: Path) -> Iterator[Look]:
    records = [path for path in sorted(_inside(folder)) if _is_record(path)]
    for fitted, held in zip(records[::2], records[1::2], strict=False):
        yield Look(line=name, file=file, fitted=fitted, held=held, recorded=_day(fitted))


def _is_record(path: Path) -> bool:
    return path.is_dir() or path.name.endswith(RECORD_ENDS)


def _inside(folder: Path) -> list[Path]:
    try:
        return list(folder.iterdir())
    except OSError as error:
        raise PlantError(f"{folder}: cannot be read ({error.strerror})") from error


def _stamp(record: Path) -> str:
    """Return size and time of change of a file, of a folder those of its files."""
    parts = sorted(record.iterdir()) if record.is_dir() else [record]
    seen = ((part.name, part.stat()) for part in parts)
    return " ".join(f"{name} {stat.st_size} {stat.st_mtime_ns}" for name, stat in seen)


def _day(record: Path) -> str:
    for found in DATE.finditer(record.name):
        try:
            return date(*map(int, found.groups())).isoformat()
        except ValueError:  # eight digits that are no day
            continue
    written = datetime.fromtimestamp(record.stat().st_mtime, tz=UTC)
    return written.date().isoformat()
