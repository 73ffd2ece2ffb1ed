"""One line's store: a folder with five Parquet files, bounded, in which nothing counts twice."""

from __future__ import annotations

import contextlib
import fcntl
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aff_runtime.app.report.parquet import (
    Columns,
    Field,
    empty,
    read_parquet,
    table,
    write_parquet,
)
from aff_runtime.app.report.watching.run_hours import HourRead, RecordedHour, RunHours
from aff_runtime.app.report.watching.tables import (
    DRIVE_FIELDS,
    EXCHANGE_FIELDS,
    HOUR_FIELDS,
    ORDER_FIELDS,
    RESPONSE_FIELDS,
    ExchangeRow,
)
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.files import CLOSED_TEXT, is_closed
from aff_runtime.base.runs.window import MARK

VERSION = "1"
MOST_HOURS, MOST_ORDERS = 10_000, 300_000
"""Rows of a store. Above that every other hour of the older half goes."""
MOST_EXCHANGES = 10_000
LONGER_S = 1.0
"""An hour of which a run now has so much more is read anew: it was still being recorded."""
FILES = {
    "hours": "hours.parquet",
    "orders": "orders.parquet",
    "exchanges": "exchanges.parquet",
    "drives": "drives.parquet",
    "responses": "responses.parquet",
}
"""By table, its file in the folder."""
OF_HOURS = (("orders", ORDER_FIELDS), ("drives", DRIVE_FIELDS), ("responses", RESPONSE_FIELDS))
"""Tables whose rows belong to an hour, beside that of the hours."""
LOCK_FLAGS = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC
NEVER = np.datetime64("1970-01-01", "us")


@dataclass(frozen=True, slots=True, kw_only=True)
class Taken:
    """What became of a run folder: hours that are new, known already, or older than what is kept.

    ``lacking`` of the new ones have no steady stretch; their web counts. ``lost`` : what is said
    of the files of the new ones.
    """

    new: int = 0
    known: int = 0
    too_old: int = 0
    lacking: int = 0
    lost: tuple[str, ...] = ()


@dataclass(slots=True, kw_only=True)
class Store:
    """What is known of one line over months.

    Attributes
    ----------
    line : its name; empty until the first run.
    hours, orders, drives, responses, exchanges : columns of the tables.
    thinned_utc : newest of the hours that were thinned out: what is older is not taken again.
    """

    line: str = ""
    hours: Columns = field(default_factory=lambda: empty(HOUR_FIELDS))
    orders: Columns = field(default_factory=lambda: empty(ORDER_FIELDS))
    drives: Columns = field(default_factory=lambda: empty(DRIVE_FIELDS))
    responses: Columns = field(default_factory=lambda: empty(RESPONSE_FIELDS))
    exchanges: Columns = field(default_factory=lambda: empty(EXCHANGE_FIELDS))
    thinned_utc: np.datetime64 = NEVER

    def unread(self, run: RunHours) -> tuple[RecordedHour, ...]:
        """Return the hours of a run that are not here yet, or were shorter.

        Raises
        ------
        ConfigError
            It is a run of another line.
        """
        return tuple(one for one, is_new in self._hours_and_whether_new(run) if is_new)

    def add(self, run: RunHours, reads: Sequence[HourRead] | None = None) -> Taken:
        """Take hours of a run that were read, by default all that are ``unread``.

        Raises
        ------
        ConfigError
            It is a run of another line.
        """
        hours_and_whether_new = list(self._hours_and_whether_new(run))
        if reads is None:
            reads = [run.read(one) for one, is_new in hours_and_whether_new if is_new]
        self.line = run.line
        row_of, known, too_old = self._row_of(run), 0, 0
        for one, is_new in hours_and_whether_new:
            at = row_of.get(one.hour)
            too_old += not is_new and at is None
            if not is_new and at is not None:
                known += 1
                self.hours["length_m"][at] = max(self.hours["length_m"][at], run.web_m(one))
        self._replace(run.run_id, reads)
        return Taken(
            new=len(reads),
            known=known,
            too_old=too_old,
            lacking=sum(bool(one.hour.lacks) for one in reads),
            lost=tuple(dict.fromkeys(text for one in reads for text in one.lost)),
        )

    def _row_of(self, run: RunHours) -> dict[int, int]:
        """Return which row each hour of a run has."""
        ours = np.flatnonzero(self.hours["run_id"] == run.run_id)
        return dict(zip(self.hours["hour"][ours].tolist(), ours.tolist(), strict=True))

    def _hours_and_whether_new(self, run: RunHours) -> Iterator[tuple[RecordedHour, bool]]:
        """Yield every hour of a run, and whether it is to be read."""
        if self.line and run.line != self.line:
            raise ConfigError(
                f"{run.folder}: a run of line {run.line}, the store is of {self.line}; nothing is "
                "taken of it. Give each line a store of its own"
            )
        row_of = self._row_of(run)
        for one in run.hours:
            at = row_of.get(one.hour)
            if at is None:
                yield one, bool(run.utc(one.from_s) > self.thinned_utc)
            else:
                yield one, bool(one.covered_s > self.hours["covered_s"][at] + LONGER_S)

    def exchange(self, roll: str, on: datetime, why: str) -> None:
        """Begin a new life of a roller; the same again changes nothing.

        Raises
        ------
        ConfigError
            The store knows no such roller, or it is a roll of web.
        """
        self.check_roller(roll)
        at = np.datetime64(on.replace(tzinfo=None), "us")
        old = self.exchanges
        if np.any((old["roll"] == roll) & (old["on_utc"] == at)):
            return
        if old["roll"].size >= MOST_EXCHANGES:
            raise ConfigError(f"the store holds {MOST_EXCHANGES} exchanges; begin another one")
        row = ExchangeRow(roll=roll, on_utc=at, why=why)
        self.exchanges = _joined(old, table(EXCHANGE_FIELDS, [row]), EXCHANGE_FIELDS)
        self._work_out_travel_and_lives()

    def check_roller(self, roll: str) -> None:
        """Do nothing where the store follows a roller of this name.

        Raises
        ------
        ConfigError
            The store knows no such roller, or it is a roll of web.
        """
        names = sorted(set(self.orders["roll"]))
        if roll not in names:
            known = ", ".join(names) or "none yet"
            raise ConfigError(f"{roll}: the store knows no such roller; it knows {known}")
        if bool(np.any(self.orders["is_roll"][self.orders["roll"] == roll])):
            raise ConfigError(
                f"{roll}: is a roll of web; each has its own shape, and no life here"
            )

    def present_life(self, roll: str, now: datetime | None = None) -> int:
        """Return the number of a roller's life at ``now`` (UTC); None: after every exchange.

        A clock that is behind the newest hour is not believed.
        """
        began = self.exchanges["on_utc"][self.exchanges["roll"] == roll]
        if now is not None:
            moment = np.datetime64(now.replace(tzinfo=None), "us")
            began = began[began <= max(moment, *self.hours["time_utc"][-1:])]
        return 1 + int(began.size)

    def _replace(self, run_id: str, reads: Sequence[HourRead]) -> None:
        """Put rows in the place of those of the same hours."""
        again = [one.hour.hour for one in reads]
        tables: list[tuple[str, Sequence[Field], list[Any]]] = [
            ("hours", HOUR_FIELDS, [one.hour for one in reads])
        ]
        for kind, layout in OF_HOURS:
            tables.append((kind, layout, [row for one in reads for row in getattr(one, kind)]))
        for name, fields, rows in tables:
            old: Columns = getattr(self, name)
            stays = ~((old["run_id"] == run_id) & np.isin(old["hour"], again))
            setattr(self, name, _joined(_chosen(old, stays), table(fields, rows), fields))
        self.responses = _chosen(self.responses, _newest_of_each(self.responses))
        self._sort()
        while self.hours["hour"].size > MOST_HOURS or any(
            getattr(self, name)["hour"].size > MOST_ORDERS for name, _ in OF_HOURS
        ):
            if not self._thin_out():
                break
        self._work_out_travel_and_lives()

    def _sort(self) -> None:
        for name in ("hours", *(name for name, _ in OF_HOURS)):
            old: Columns = getattr(self, name)
            setattr(self, name, _chosen(old, np.argsort(old["time_utc"], kind="stable")))

    def _thin_out(self) -> bool:
        """Take every other hour of the older half out; its web counts for the one before."""
        half = self.hours["hour"].size // 2
        gone = np.arange(1, half, 2)
        if not gone.size:
            return False
        self.hours["length_m"][gone - 1] += self.hours["length_m"][gone]
        self.thinned_utc = max(self.thinned_utc, self.hours["time_utc"][gone[-1]])
        stays = np.ones(self.hours["hour"].size, dtype=np.bool_)
        stays[gone] = False
        self.hours = _chosen(self.hours, stays)
        self.drop_orphans()
        return True

    def drop_orphans(self) -> None:
        """Take out what belongs to no hour: a crash between two files leaves some."""
        known = set(zip(self.hours["run_id"], self.hours["hour"], strict=True))
        for name, _ in OF_HOURS:
            old: Columns = getattr(self, name)
            keys = zip(old["run_id"], old["hour"], strict=True)
            stays = np.fromiter((key in known for key in keys), np.bool_, old["hour"].size)
            setattr(self, name, _chosen(old, stays))

    def _work_out_travel_and_lives(self) -> None:
        """Work out how far the web had run at each hour, and the life of each roller."""
        hours = self.hours
        before = np.cumsum(hours["length_m"]) - hours["length_m"]
        hours["travelled_km"] = 1e-3 * (before + hours["offset_m"])
        at = dict(
            zip(
                zip(hours["run_id"], hours["hour"], strict=True),
                hours["travelled_km"],
                strict=True,
            )
        )
        for name, _ in OF_HOURS:
            rows: Columns = getattr(self, name)
            keys = zip(rows["run_id"], rows["hour"], strict=True)
            rows["travelled_km"] = np.fromiter((at[key] for key in keys), np.float64)
            rows["life"] = np.ones(rows["hour"].size, dtype=np.int64)
            for roll, on in zip(self.exchanges["roll"], self.exchanges["on_utc"], strict=True):
                rows["life"] += (rows["roll"] == roll) & (rows["time_utc"] >= on)


def load_store(folder: Path, *, begin: bool = False) -> Store:
    """Return a store; with ``begin`` an empty one where none is there yet.

    Raises
    ------
    ConfigError
        It is not there, is not ours to look at, or one of its files cannot be read.
    """
    paths = {table: folder / name for table, name in FILES.items()}
    if is_closed(paths["hours"]):
        raise ConfigError(f"{folder}: {CLOSED_TEXT}")
    if not paths["hours"].exists():
        if begin:
            return _begun(paths["exchanges"])
        raise ConfigError(
            f"{folder}: holds no store; `aff-runtime watch add STORE RUN_DIR` begins one"
        )
    hours, about = read_parquet(paths["hours"], HOUR_FIELDS)
    if about.get("version") != VERSION or not about.get("line"):
        raise ConfigError(
            f"{paths['hours']}: is no store of this release's `aff-runtime watch`; move it away"
        )
    wanted = ("orders", *about.get("tables", "").split())
    if not all((folder / f"{name}.parquet").exists() for name in wanted):
        # somebody moved a broken one away: its hours are to be read again
        return _begun(paths["exchanges"], about["line"])
    others = {
        name: read_parquet(paths[name], fields)[0] if paths[name].exists() else empty(fields)
        for name, fields in (*OF_HOURS, ("exchanges", EXCHANGE_FIELDS))
    }
    store = Store(
        line=about["line"],
        hours=hours,
        **others,
        thinned_utc=np.datetime64(about.get("thinned_utc", str(NEVER)), "us"),
    )
    store.drop_orphans()
    return store


def _begun(exchanges: Path, line: str = "") -> Store:
    """Return a store without hours, with the exchanges that people reported."""
    if not exchanges.exists():
        return Store(line=line)
    rows, about = read_parquet(exchanges, EXCHANGE_FIELDS)
    return Store(line=line or about.get("line", ""), exchanges=rows)


def save_store(folder: Path, store: Store) -> None:
    """Replace the files of a store, each whole or not at all; the hours last: they count.

    Raises
    ------
    ConfigError
        One cannot be written.
    """
    about = {"line": store.line, "version": VERSION, "thinned_utc": str(store.thinned_utc)}
    about["tables"] = " ".join(name for name, _ in OF_HOURS)
    in_order = (
        ("exchanges", EXCHANGE_FIELDS, store.exchanges),
        ("responses", RESPONSE_FIELDS, store.responses),
        ("drives", DRIVE_FIELDS, store.drives),
        ("orders", ORDER_FIELDS, store.orders),
        ("hours", HOUR_FIELDS, store.hours),
    )
    for name, fields, columns in in_order:
        write_parquet(folder / FILES[name], fields, columns, about)


@contextlib.contextmanager
def lock_store(folder: Path) -> Iterator[None]:
    """Hold a store for oneself while it is read, changed and written.

    Raises
    ------
    ConfigError
        Another command has it, or the folder cannot be used.
    """
    if (folder / MARK).exists():
        raise ConfigError(
            f"{folder}: is a run folder, and no store; the store comes first: "
            "`aff-runtime watch add STORE RUN_DIR`"
        )
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock = os.open(folder / ".lock", LOCK_FLAGS, 0o644)
    except OSError as error:
        raise ConfigError(f"{folder}: no folder for a store ({error.strerror})") from None
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield
    except BlockingIOError:
        raise ConfigError(f"{folder}: another `aff-runtime watch` is at it; try again") from None
    finally:
        os.close(lock)


def _chosen(columns: Columns, which: NDArray[np.bool_] | NDArray[np.intp]) -> Columns:
    return {name: values[which] for name, values in columns.items()}


def _newest_of_each(rows: Columns) -> NDArray[np.intp]:
    """Return the last row of each response: its hour may be gone, and another one the nearest."""
    names = ("run_id", "time_utc", "actuator", "frequency_Hz")
    keys = zip(*(rows[name].tolist() for name in names), strict=True)
    return np.array(sorted({key: at for at, key in enumerate(keys)}.values()), dtype=np.intp)


def _joined(first: Columns, second: Columns, fields: Sequence[Field]) -> Columns:
    return {f.name: np.concatenate([first[f.name], second[f.name]]) for f in fields}
