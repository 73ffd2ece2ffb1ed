"""Events of a line as they are kept: words in English with their values, told in any language."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

SCHEMA = (
    "CREATE TABLE IF NOT EXISTS events (id INTEGER PRIMARY KEY AUTOINCREMENT, "
    "utc_s REAL NOT NULL, tick INTEGER, kind TEXT NOT NULL, roll TEXT NOT NULL, "
    "name TEXT NOT NULL, said TEXT NOT NULL, said_values TEXT NOT NULL, who TEXT NOT NULL, "
    "once TEXT UNIQUE)",
    "CREATE INDEX IF NOT EXISTS events_at ON events (utc_s, id)",
)
MOST_EVENTS = 100_000
YEAR_S = 366 * 86_400.0
MOST_ROWS = 100
_COLUMNS = "id, utc_s, tick, kind, roll, name, said, said_values, who"


class Kind(StrEnum):
    """Category of an event."""

    ALARM = "alarm"
    STATE = "state"
    ROLL = "roll"
    SETTINGS = "settings"
    SERVICE = "service"
    PERSON = "person"


@dataclass(frozen=True, slots=True, kw_only=True)
class KeptEvent:
    """One event.

    Attributes
    ----------
    utc_s : wall time. ``tick`` : of the control cycle; None for what no tick has seen.
    roll : that it is of, empty for none.
    text : in English, with ``{name}`` for each of ``values``. ``who`` : account, empty for none.
    unique_key : a second event with the same key is not kept; empty: never a duplicate.
    number : of the row; 0 before it is kept.
    """

    utc_s: float
    kind: Kind
    name: str
    text: str
    tick: int | None = None
    roll: str = ""
    values: Mapping[str, str] = field(default_factory=dict)
    who: str = ""
    unique_key: str = ""
    number: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Wanted:
    """Which events: of a kind, of a roll (empty: any), older than the row ``before`` (0: all)."""

    kind: str = ""
    roll: str = ""
    before: int = 0
    most: int = MOST_ROWS


def insert(connection: sqlite3.Connection, entries: Sequence[KeptEvent]) -> None:
    """Keep events; one that is there already is not kept again."""
    connection.executemany(
        "INSERT OR IGNORE INTO events "
        "(utc_s, tick, kind, roll, name, said, said_values, who, once) "
        "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)",
        [
            (
                *(one.utc_s, one.tick, one.kind, one.roll, one.name, one.text),
                *(json.dumps(dict(one.values)), one.who, one.unique_key or None),
            )
            for one in entries
        ],
    )


def prune(connection: sqlite3.Connection, now_s: float, *, is_full: bool) -> None:
    """Delete what is older than a year, the oldest above the most, a tenth on a full disk."""
    connection.execute("DELETE FROM events WHERE utc_s < ?", (now_s - YEAR_S,))
    (count,) = connection.execute("SELECT count(*) FROM events").fetchone()
    too_many = max(count - MOST_EVENTS, count // 10 if is_full else 0)
    connection.execute(
        "DELETE FROM events WHERE id IN (SELECT id FROM events ORDER BY id LIMIT ?)", (too_many,)
    )


def select(connection: sqlite3.Connection, wanted: Wanted) -> list[KeptEvent]:
    """Return events, the newest first."""
    rows = connection.execute(
        f"SELECT {_COLUMNS} FROM events WHERE (?1 = '' OR kind = ?1) AND (?2 = '' OR roll = ?2) "
        "AND (?3 = 0 OR id < ?3) ORDER BY id DESC LIMIT ?4",
        (wanted.kind, wanted.roll, wanted.before, wanted.most),
    )
    return [_entry(row) for row in rows]


def between(
    connection: sqlite3.Connection,
    from_s: float,
    to_s: float,
    *,
    kind: Kind,
    names: Sequence[str],
    most: int,
) -> list[KeptEvent]:
    """Return the newest events of a span that are of a kind or have one of the names.

    Parameters
    ----------
    from_s, to_s : wall time, inclusive.

    Returns
    -------
    list of KeptEvent
        ``most`` at most, the oldest first.
    """
    marks = ", ".join("?" for _ in names)
    rows = connection.execute(
        f"SELECT {_COLUMNS} FROM events WHERE utc_s >= ? AND utc_s <= ? "
        f"AND (kind = ? OR name IN ({marks})) ORDER BY utc_s DESC, id DESC LIMIT ?",
        (from_s, to_s, kind, *names, most),
    )
    return [_entry(row) for row in rows][::-1]


def newest(connection: sqlite3.Connection) -> int:
    """Return the number of the newest row; 0 when there is none."""
    (found,) = connection.execute("SELECT coalesce(max(id), 0) FROM events").fetchone()
    return int(found)


def _entry(row: tuple[int, float, int | None, str, str, str, str, str, str]) -> KeptEvent:
    number, utc_s, tick, kind, roll, name, text, values, who = row
    return KeptEvent(
        number=number,
        utc_s=utc_s,
        tick=tick,
        kind=Kind(kind),
        roll=roll,
        name=name,
        text=text,
        values=json.loads(values),
        who=who,
    )
