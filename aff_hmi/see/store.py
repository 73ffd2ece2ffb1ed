"""One SQLite file of the screen, and the one thread that touches it; memory where none is named.

The event loop never waits for a disk: what is written is handed over, what is read is awaited.
When the disk does not keep up, or fails, nothing but history is lost, and that is told.
"""

from __future__ import annotations

import asyncio
import sqlite3
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import TypeAlias, TypeVar

from aff_runtime.base.errors import ConfigError

Found = TypeVar("Found")
Work: TypeAlias = Callable[[sqlite3.Connection], Found]
PAGE_BYTES = 4096
MOST_BYTES = 200_000_000
MOST_WAITING = 64
MOST_ASKED = 16  # of them, that only read: what is written has the other places for itself
ROOM = 0.9  # of the bound, above which the oldest go
FILE = "screen.sqlite"


class Store:
    """Keeps rows within a bound of bytes.

    Parameters
    ----------
    folder : of the file, made when it is not there; None keeps all in memory, until the end.
    schema : statements that make the tables where they are missing.
    most_bytes : bound of the file; in memory it is a tenth.

    Attributes
    ----------
    is_lasting : whether it outlives the screen. ``most_bytes`` : its bound.
    trouble : what failed last, in words.
    lost_count : writes that were not done.

    Raises
    ------
    ConfigError
        When the folder cannot be written, or another screen keeps its history there.
    """

    def __init__(
        self, folder: Path | None, schema: Sequence[str], most_bytes: int = MOST_BYTES
    ) -> None:
        self.is_lasting = folder is not None
        self.trouble = ""
        self.lost_count = 0
        self.most_bytes = most_bytes if folder else most_bytes // 10
        self._pages = max(64, self.most_bytes // PAGE_BYTES)
        self._waiting = self._asked = 0
        self._counting = threading.Lock()
        self._executor = ThreadPoolExecutor(max_workers=1, thread_name_prefix="history")
        self._connection = self._executor.submit(self._open, folder, schema).result()

    def put(self, work: Work[object]) -> None:
        """Have something written soon; it is counted when it cannot be."""
        if not self._has_room():
            self.lost_count += 1
            self.trouble = "the disk does not keep up"
            return
        self._executor.submit(self._write, work)

    async def ask(self, work: Work[Found]) -> Found:
        """Return what is read.

        Raises
        ------
        BlockingIOError
            When too much waits already. ``sqlite3.Error`` when it cannot be read.
        """
        if not self._has_room(reads=True):
            raise BlockingIOError
        return await asyncio.wrap_future(self._executor.submit(self._read, work))

    async def change(self, work: Work[Found]) -> Found:
        """Write something whole or not at all, and return what comes of it.

        Raises
        ------
        BlockingIOError
            When too much waits already. ``sqlite3.Error`` when it cannot be written; what the
            work itself raises.
        """
        if not self._has_room():
            raise BlockingIOError
        return await asyncio.wrap_future(self._executor.submit(self._changed, work))

    def now(self, work: Work[Found]) -> Found:
        """Return what is read, waiting for it: at the start, and in tests."""
        asked: Future[Found] = self._executor.submit(work, self._connection)
        return asked.result()

    def close(self) -> None:
        """Write what waits, and close."""
        self._executor.submit(self._connection.close)
        self._executor.shutdown()

    def is_full(self, connection: sqlite3.Connection) -> bool:
        """Return whether the oldest rows have to go; in the thread."""
        (pages,) = connection.execute("PRAGMA page_count").fetchone()
        (free,) = connection.execute("PRAGMA freelist_count").fetchone()
        return bool(pages - free > ROOM * self._pages)

    def _has_room(self, *, reads: bool = False) -> bool:
        """Take a place among those that wait; False when there is none."""
        with self._counting:
            has_room = self._waiting < MOST_WAITING and not (reads and self._asked >= MOST_ASKED)
            self._waiting += has_room
            self._asked += has_room and reads
        return has_room

    # --- in the thread ----------------------------------------------------------------------

    def _open(self, folder: Path | None, schema: Sequence[str]) -> sqlite3.Connection:
        path = ":memory:" if folder is None else str(folder / FILE)
        try:
            if folder is not None:
                folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            return self._opened(path, schema)
        except sqlite3.OperationalError as error:
            raise ConfigError(
                f"{path}: {error}; give this screen a folder of its own with --state"
            ) from None
        except OSError as error:
            raise ConfigError(f"{folder}: {error.strerror}; name another with --state") from None
        except sqlite3.DatabaseError as error:  # it is no database, or a damaged one
            damaged = Path(path).with_suffix(".damaged")
            Path(path).replace(damaged)
            self.trouble = f"{error}: begun anew, the old file is {damaged.name}"
            return self._opened(path, schema)

    def _opened(self, path: str, schema: Sequence[str]) -> sqlite3.Connection:
        connection = sqlite3.connect(path, timeout=0.0, isolation_level=None)
        try:
            for pragma in (
                f"page_size = {PAGE_BYTES}",
                "locking_mode = EXCLUSIVE",
                "journal_mode = WAL",
                "synchronous = NORMAL",
                "cache_size = -2000",
                "wal_autocheckpoint = 500",
                f"max_page_count = {self._pages}",
            ):
                connection.execute(f"PRAGMA {pragma}").fetchall()
            connection.execute("BEGIN IMMEDIATE")
            for statement in schema:
                connection.execute(statement)
            connection.execute("COMMIT")
            (found,) = connection.execute("PRAGMA quick_check(1)").fetchone()
            if found != "ok":  # one page: what is asked later would fail, the start with it
                raise sqlite3.DatabaseError(found.splitlines()[-1])
        except sqlite3.Error:
            connection.close()
            raise
        return connection

    def _begin(self, *, reads: bool = False) -> None:
        with self._counting:
            self._waiting -= 1
            self._asked -= reads

    def _write(self, work: Work[object]) -> None:
        self._begin()
        try:
            self._connection.execute("BEGIN")
            work(self._connection)
            self._connection.execute("COMMIT")
            self.trouble = ""
        except sqlite3.Error as error:
            self.lost_count += 1
            self.trouble = str(error)
            if self._connection.in_transaction:
                self._connection.execute("ROLLBACK")

    def _changed(self, work: Work[Found]) -> Found:
        self._begin()
        self._connection.execute("BEGIN")
        try:
            found = work(self._connection)
            self._connection.execute("COMMIT")
        finally:
            if self._connection.in_transaction:
                self._connection.execute("ROLLBACK")
        return found

    def _read(self, work: Work[Found]) -> Found:
        self._begin(reads=True)
        return work(self._connection)
