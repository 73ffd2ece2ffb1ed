"""The audit: one JSON object a line, each with the hash of the line before.

Nobody can take a line out, change one or put one in without every later hash being wrong. Who
may write the file can forge the whole of it: so the newest hash stands in the service's log too.
"""

from __future__ import annotations

import contextlib
import fcntl
import hashlib
import json
import os
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

from aff_runtime.app.link.runtime_directory import WRITTEN_BY_OTHERS
from aff_runtime.base.clock import wall_time_iso
from aff_runtime.base.errors import ConfigError, RefusedError
from aff_runtime.base.printable import printable

MAX_BYTES = 8 << 20  # of a file, after which another one begins
KEPT_FILES = 8
LONGEST_LINE = 8192  # bytes
NAME = "audit.jsonl"
START = "0" * 64  # stands for the hash before the first line of all
_FLAGS = os.O_RDWR | os.O_APPEND | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW


@dataclass(frozen=True, slots=True, kw_only=True)
class AuditEntry:
    """What one line says.

    Attributes
    ----------
    what : a command or a notice. ``result`` : asked, done, refused, or noted.
    account, role, place : as the screen claims. ``peer`` : whose process it was, by the kernel.
    seen, state : the guard's state that the person saw, and the true one. ``config`` : revision
        in force.
    """

    what: str
    result: str
    why: str = ""
    account: str = ""
    role: str = ""
    place: str = ""
    peer: str = ""
    seen: str = ""
    state: str = ""
    tick: int = 0
    config: str = ""
    id: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Chain:
    """How far a chain holds: its first and last number, the newest hash, and what is wrong."""

    first: int = 0
    last: int = 0
    newest: str = START
    wrong: str = ""


class Audit:
    """The file that is written; bounded, the oldest of ``KEPT_FILES`` goes.

    Attributes
    ----------
    newest : hash of the last line. ``last`` : its number.

    Raises
    ------
    RefusedError
        When it cannot be written, another service writes it, or what is there does not hold.
    """

    def __init__(
        self, folder: Path, now: Callable[[], str] = wall_time_iso, max_bytes: int = MAX_BYTES
    ) -> None:
        self.path = folder / NAME
        self._now = now
        self._max_bytes = max_bytes
        self._is_whole = True
        self._size = self.last = 0
        self.newest = START
        self._lock = -1
        try:
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            _check_own(folder)
            self._lock = os.open(folder / "audit.lock", _FLAGS, 0o600)
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            self._file = os.open(self.path, _FLAGS, 0o600)
        except BlockingIOError:
            os.close(self._lock)
            raise RefusedError(f"{self.path}: another service writes this audit") from None
        except OSError as error:
            if self._lock >= 0:
                os.close(self._lock)
            raise RefusedError(f"{self.path}: {error.strerror}; no hand without it") from None
        try:
            self._continue()
        except OSError as error:
            self.close()
            raise RefusedError(f"{self.path}: {error.strerror}; no hand without it") from None
        except BaseException:
            self.close()
            raise

    def add(self, entry: AuditEntry) -> int:
        """Put one line on record; return its number.

        Raises
        ------
        RefusedError
            When it cannot be written; then nothing of it is there.
        """
        if not self._is_whole:
            raise RefusedError(f"{self.path}: half a line could not be taken back")
        try:
            self._stay_at_path()
            if self._size >= self._max_bytes:
                self._rotate()
            said = {name: _short(value) for name, value in asdict(entry).items()}
            row = {"n": self.last + 1, "utc": self._now(), **said, "prev": self.newest}
            line = json.dumps(row, separators=(",", ":")).encode()
            self._write(line + b"\n")
        except OSError as error:
            raise RefusedError(f"{self.path}: {error.strerror}") from None
        self.last += 1
        self.newest = hashlib.sha256(line).hexdigest()
        return self.last

    def close(self) -> None:
        """End it."""
        os.close(self._file)
        os.close(self._lock)

    def _continue(self) -> None:
        """Go on after the last line; half a line (a loss of power) is cut off and noted."""
        longest = self._max_bytes + LONGEST_LINE
        content = os.pread(self._file, longest + 1, 0)
        whole, _, rest = content.rpartition(b"\n")
        if len(content) > longest or len(rest) > LONGEST_LINE:
            raise RefusedError(f"{self.path}: is no audit of ours; look at it, then move it away")
        chain = follow(whole.split(b"\n")) if whole else self._of_older()
        if chain.wrong:
            raise RefusedError(
                f"{self.path}: the chain does not hold: {chain.wrong}; look, then move it away"
            )
        self.last, self.newest = chain.last, chain.newest
        self._size = len(content) - len(rest)
        if rest:
            os.ftruncate(self._file, self._size)
            self.add(
                AuditEntry(what="start", result="noted", why=f"{len(rest)} bytes were half a line")
            )

    def _of_older(self) -> Chain:
        """Return the chain that a file without a line goes on from."""
        older = self.path.with_name(f"{NAME}.1")
        try:
            return follow(older.read_bytes().split(b"\n")[:-1]) if older.exists() else Chain()
        except OSError as error:
            return Chain(wrong=f"{older}: {error.strerror}")

    def _write(self, line: bytes) -> None:
        """Append one line, whole or not at all."""
        written = 0
        try:
            while written < len(line):
                written += os.write(self._file, line[written:])
        except OSError:
            with contextlib.suppress(OSError):
                self._is_whole = False
                os.ftruncate(self._file, self._size)
                self._is_whole = True
            raise
        self._size += len(line)

    def _stay_at_path(self) -> None:
        """Go on in a new file when ours was moved away: the chain goes on, and shows the gap."""
        own = os.fstat(self._file)
        with contextlib.suppress(FileNotFoundError):
            if os.path.samestat(os.lstat(self.path), own):
                return
        fresh = os.open(self.path, _FLAGS, 0o600)
        if os.fstat(fresh).st_size:
            os.close(fresh)
            raise RefusedError(
                f"{self.path}: another file is in its place; look, then move it away"
            )
        os.close(self._file)
        self._file, self._size = fresh, 0

    def _rotate(self) -> None:
        """Begin another file; its first line holds the hash of the last line of this one."""
        for number in range(KEPT_FILES - 1 if self.path.exists() else 0, 0, -1):
            newer = self.path.with_name(f"{NAME}.{number - 1}") if number > 1 else self.path
            if newer.exists():
                newer.rename(self.path.with_name(f"{NAME}.{number}"))
        fresh = os.open(self.path, _FLAGS | os.O_EXCL, 0o600)
        os.close(self._file)
        self._file, self._size = fresh, 0


def follow(lines: list[bytes], before: Chain | None = None) -> Chain:
    """Return how far a chain holds over these lines.

    Parameters
    ----------
    before : chain that they go on from; None: the first line's number and ``prev`` are taken.
    """
    first, last = (before.first, before.last) if before else (0, 0)
    newest = before.newest if before else ""
    for at, line in enumerate(lines, start=1):
        try:
            row = json.loads(line)
            number, prev = row["n"], row["prev"]
        except (ValueError, KeyError, TypeError, RecursionError):
            return Chain(first=first, last=last, newest=newest, wrong=f"line {at} is none of ours")
        is_number = isinstance(number, int) and not isinstance(number, bool) and number > 0
        begins = not newest
        if begins and number == 1 and prev != START:
            return Chain(wrong=f"line {at}: the first of all has something before it")
        if not is_number or not (begins or (number == last + 1 and prev == newest)):
            said = f"line {at}: number {number!a:.20} does not follow {last}"
            wrong = (
                said if number != last + 1 else f"line {at}, number {number}: not what followed"
            )
            return Chain(first=first, last=last, newest=newest, wrong=wrong)
        first, last = first or number, number
        newest = hashlib.sha256(line).hexdigest()
    return Chain(first=first, last=last, newest=newest or START)


def verify(path: Path) -> Chain:
    """Return how far the chain of a file holds, with its older files beside it.

    Raises
    ------
    ConfigError
        When it cannot be read.
    """
    chain: Chain | None = None
    for file in _oldest_first(path):
        try:
            content = file.read_bytes()
        except OSError as error:
            raise ConfigError(f"{file}: {error.strerror}; name an audit file") from None
        whole, _, rest = content.rpartition(b"\n")
        chain = follow(whole.split(b"\n") if whole else [], chain)
        if not chain.wrong and rest:
            chain = Chain(
                first=chain.first,
                last=chain.last,
                newest=chain.newest,
                wrong="ends in half a line",
            )
        if chain.wrong:
            return Chain(
                first=chain.first,
                last=chain.last,
                newest=chain.newest,
                wrong=f"{file.name}: {chain.wrong}",
            )
    assert chain is not None
    return chain


def _check_own(folder: Path) -> None:
    found = folder.lstat()
    if found.st_uid != os.geteuid() or found.st_mode & WRITTEN_BY_OTHERS:
        raise RefusedError(f"{folder}: others than user {os.geteuid()} may write in it")


def _oldest_first(path: Path) -> Iterator[Path]:
    for number in range(KEPT_FILES, 0, -1):
        older = path.with_name(f"{path.name}.{number}")
        if older.exists():
            yield older
    yield path


def _short(value: str | int) -> str | int:
    return printable(value, 300) if isinstance(value, str) else value
