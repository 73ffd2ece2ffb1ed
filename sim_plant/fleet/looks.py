"""What a fleet has: a line file per line, and its records in the order in which they were made."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, date, datetime
from pathlib import Path
from typing import NamedTuple

from aff_runtime.base.errors import PlantError

RECORD_ENDS = (".csv", ".csv.gz", ".txt", ".parquet", ".mf4")
DATE = re.compile(r"(?<!\d)(20\d\d)-?(\d\d)-?(\d\d)(?:\d{6})?(?!\d)")
"""A day, with or without the time after it: no part of a longer number."""


class Mark(NamedTuple):
    """What tells a look from others: it is taken once, and its files may be edited meanwhile.

    Attributes
    ----------
    key : name of its row; another line file or another record is another look.
    declared : which line file it is, the first digits of its hash.
    """

    key: str
    declared: str


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
        """Name of its row as its files are now, see ``mark``."""
        return self.mark().key

    def mark(self) -> Mark:
        """Return what tells it from others, by its files as they are now."""
        digest = hashlib.sha256(_content(self.file))
        declared = digest.hexdigest()[:16]
        for record in (self.fitted, self.held):
            digest.update(f"{record.name} {_stamp(record)}".encode())
        return Mark(f"{self.line}-{digest.hexdigest()[:16]}", declared)

    @property
    def pair(self) -> tuple[str, str, str]:
        """Line and names of both records."""
        return self.line, self.fitted.name, self.held.name


class Told(NamedTuple):
    """Two records that are a look already, by the row that is kept of it."""

    line: str
    fitted: str
    held: str
    failed: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Closed:
    """A line whose folder of records cannot be read, since which day, and why not."""

    line: str
    recorded: str
    error: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Fleet:
    """Names of all lines, their looks, and the lines whose records cannot be read."""

    lines: frozenset[str]
    looks: Sequence[Look]
    closed: Sequence[Closed]


def fleet_in(lines: Path, runs: Path, told: Iterable[Told] = ()) -> Fleet:
    """Return every line and look that two folders hold.

    ``lines`` has a file NAME.yaml per line, ``runs`` a folder NAME per line with its records, by
    name in the order of time. What was ``told`` of stays a look; of the other records each two
    are one, and one left over waits for the next.

    Raises
    ------
    PlantError
        When one of the two folders cannot be read, there is no line, or a folder of records has
        no line.
    """
    files = {path.stem: path for path in sorted(_inside(lines)) if path.suffix == ".yaml"}
    if not files:
        raise PlantError(f"{lines}: no line file NAME.yaml in it")
    folders = {path.name: path for path in sorted(_inside(runs)) if _is_there(path, files.keys())}
    strangers = sorted(folders.keys() - files.keys())
    if strangers:
        raise PlantError(
            f"{runs}: the folder {strangers[0]} has no line file; put {strangers[0]}.yaml into "
            f"{lines}, or take the folder away"
        )
    of_line: dict[str, list[Told]] = {}
    for one in sorted(told, key=lambda one: (one.failed, one)):
        of_line.setdefault(one.line, []).append(one)
    looks: list[Look] = []
    closed = []
    for name, folder in folders.items():
        try:
            records = [path for path in sorted(_inside(folder)) if _is_record(path)]
        except PlantError as error:
            closed.append(Closed(line=name, recorded=_day(folder), error=str(error)))
            continue
        looks += _looks(name, files[name], records, of_line.get(name, ()))
    return Fleet(lines=frozenset(files), looks=looks, closed=closed)


def _looks(name: str, file: Path, records: Sequence[Path], told: Sequence[Told]) -> Iterator[Look]:
    """Yield the looks of a line by the names of their records.

    A record that was told of is of no other look, also when the other one of the pair is gone:
    what is taken away or put between would else make every look after it a new one. Where the
    look had failed nothing is known of the one that is left, and it is free.
    """
    there = {path.name: path for path in records}
    taken: set[str] = set()
    pairs = []
    for one in told:
        both = {one.fitted, one.held}
        if both & taken or (one.failed and not both <= there.keys()):
            continue
        taken |= both
        if both <= there.keys():
            pairs.append((there[one.fitted], there[one.held]))
    free = [path for path in records if path.name not in taken]
    pairs += zip(free[::2], free[1::2], strict=False)
    for fitted, held in sorted(pairs):
        yield Look(line=name, file=file, fitted=fitted, held=held, recorded=_day(fitted))


def _is_there(path: Path, lines: Iterable[str]) -> bool:
    """Return whether it is the folder of a line, or stands for one and leads nowhere."""
    return os.path.isdir(path) or (path.name in lines and not os.path.exists(path))


def _is_record(path: Path) -> bool:
    """Return whether it is a record; what is listed and cannot be looked at may be one."""
    return path.name.endswith(RECORD_ENDS) or os.path.isdir(path) or not os.path.exists(path)


def _inside(folder: Path) -> list[Path]:
    try:
        return list(folder.iterdir())
    except OSError as error:
        raise PlantError(f"{folder}: cannot be read ({error.strerror})") from error


def _content(file: Path) -> bytes:
    """Return what a file holds; nothing where it cannot be read: refine says why."""
    try:
        return file.read_bytes()
    except OSError:
        return b""


def _stamp(record: Path) -> str:
    """Return size and time of change of a file, of a folder those of its files.

    What cannot be read has its error there: refine fails on it by name, and once it can be read
    it is another look.
    """
    try:
        parts = sorted(record.iterdir()) if os.path.isdir(record) else [record]
    except OSError as error:
        return f"{record.name} {error.strerror}"
    return " ".join(f"{part.name} {_size_and_time(part)}" for part in parts)


def _size_and_time(part: Path) -> str:
    try:
        seen = part.stat()
    except OSError as error:
        return str(error.strerror)
    return f"{seen.st_size} {seen.st_mtime_ns}"


def _day(record: Path) -> str:
    for found in DATE.finditer(record.name):
        try:
            return date(*map(int, found.groups())).isoformat()
        except ValueError:  # eight digits that are no day
            continue
    for seen in (record.stat, record.lstat):  # of a link that leads nowhere its own
        try:
            return datetime.fromtimestamp(seen().st_mtime, tz=UTC).date().isoformat()
        except OSError:
            continue
    return date.fromtimestamp(0).isoformat()
