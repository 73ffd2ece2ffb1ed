"""Rows of kept windows: a share of the store is theirs, and nothing pushes them out."""

from __future__ import annotations

import json
import sqlite3
import zlib
from dataclasses import asdict, dataclass

import numpy as np

from aff_hmi.scope.signals import Signal
from aff_hmi.scope.ticks import Cut

SCHEMA = (
    "CREATE TABLE IF NOT EXISTS kept (id INTEGER PRIMARY KEY AUTOINCREMENT, "
    "said TEXT NOT NULL, head TEXT NOT NULL, data BLOB NOT NULL)"
)
MOST = 100
SHARE = 0.2  # of the store
MOST_OF_ALARMS = 60
SHARE_OF_ALARMS = 0.1
_ALARM = "coalesce(json_extract(said, '$.alarm'), '')"
_SIZES = f"SELECT id, length(data) FROM kept WHERE ({_ALARM} = '') = ? ORDER BY id"


@dataclass(frozen=True, slots=True, kw_only=True)
class Window:
    """What is said of a kept window.

    Attributes
    ----------
    utc_s : wall time of its first tick. ``first``, ``last`` : numbers of its ticks.
    run : name of the run folder that the service recorded it in, empty for none.
    config : revision of the settings. ``line`` : name of the line. ``size`` : bytes kept.
    alarm : around which it was kept by itself; empty: a person kept it.
    """

    name: str
    note: str
    who: str
    utc_s: float
    seconds: float
    first: int
    last: int
    run: str
    config: str
    line: str
    alarm: str = ""
    size: int = 0
    number: int = 0


class FullError(Exception):
    """No space is left: somebody has to delete a window first."""


def begin(connection: sqlite3.Connection) -> None:
    """Make the table where it is not there."""
    connection.execute(SCHEMA)


def keep(connection: sqlite3.Connection, said: Window, cut: Cut, most_bytes: int) -> int:
    """Keep a window; return its number.

    Raises
    ------
    FullError
        When the share is full; nothing is deleted by itself.
    """
    head, data = packed(cut)
    sizes = [size for _, size in connection.execute(_SIZES, (True,))]
    if len(sizes) >= MOST or sum(sizes) + len(data) > most_bytes:
        raise FullError
    return _insert(connection, said, head, data)


def keep_of_alarm(connection: sqlite3.Connection, said: Window, cut: Cut, most_bytes: int) -> None:
    """Keep a window of an alarm; the oldest ones of alarms go for it, and no other."""
    head, data = packed(cut)
    there = list(connection.execute(_SIZES, (False,)))
    while there and (
        len(there) >= MOST_OF_ALARMS or sum(n for _, n in there) + len(data) > most_bytes
    ):
        connection.execute("DELETE FROM kept WHERE id = ?", (there.pop(0)[0],))
    if len(data) <= most_bytes:
        _insert(connection, said, head, data)


def _insert(connection: sqlite3.Connection, said: Window, head: str, data: bytes) -> int:
    row = asdict(said) | {"size": len(data)}
    found = connection.execute(
        "INSERT INTO kept (said, head, data) VALUES (?, ?, ?)", (json.dumps(row), head, data)
    )
    return int(found.lastrowid or 0)


def listed(connection: sqlite3.Connection) -> list[Window]:
    """Return what is said of every window, the newest first."""
    rows = connection.execute("SELECT id, said FROM kept ORDER BY id DESC").fetchall()
    return [Window(**(json.loads(said) | {"number": number})) for number, said in rows]


def ticks_of(connection: sqlite3.Connection, number: int) -> Cut | None:
    """Return the ticks of a window; None when there is none of that number."""
    row = connection.execute("SELECT head, data FROM kept WHERE id = ?", (number,)).fetchone()
    return None if row is None else unpacked(*row)


def delete(connection: sqlite3.Connection, number: int) -> str:
    """Delete a window; return its name, empty when there was none."""
    row = connection.execute("SELECT said FROM kept WHERE id = ?", (number,)).fetchone()
    connection.execute("DELETE FROM kept WHERE id = ?", (number,))
    return "" if row is None else str(json.loads(row[0])["name"])


def packed(cut: Cut) -> tuple[str, bytes]:
    """Return a cut as a head in JSON and its numbers, compressed."""
    head = {
        "n": len(cut),
        "cycle_s": cut.cycle_s,
        "utc_s": cut.utc_s,
        "signals": [asdict(one) for one in cut.signals],
        "events": cut.events,
    }
    parts = (cut.ticks.astype("<i8"), cut.time_s.astype("<f8"), cut.states.astype("i1"))
    raw = b"".join(part.tobytes() for part in (*parts, cut.values.astype("<f4")))
    return json.dumps(head), zlib.compress(raw, 1)


def unpacked(head: str, data: bytes) -> Cut:
    """Return the cut of ``packed``."""
    said = json.loads(head)
    n, signals = said["n"], tuple(Signal(**one) for one in said["signals"])
    raw = memoryview(zlib.decompress(data))
    return Cut(
        ticks=np.frombuffer(raw[: 8 * n], dtype="<i8"),
        time_s=np.frombuffer(raw[8 * n : 16 * n], dtype="<f8"),
        states=np.frombuffer(raw[16 * n : 17 * n], dtype="i1"),
        values=np.frombuffer(raw[17 * n :], dtype="<f4").reshape(n, len(signals)),
        signals=signals,
        cycle_s=said["cycle_s"],
        utc_s=said["utc_s"],
        events=tuple((tick, code) for tick, code in said["events"]),
    )
