"""Takes what is new of runs into a store, hour by hour: what was read is kept whatever comes."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from aff_runtime.app.report.watch_notes import Limits, WatchNotes, read_notes, write_notes
from aff_runtime.app.report.watching import sentences
from aff_runtime.app.report.watching.findings import findings
from aff_runtime.app.report.watching.run_hours import HourRead, RunHours, run_hours
from aff_runtime.app.report.watching.store import Store, load_store, lock_store, save_store
from aff_runtime.base.clock import wall_time_iso
from aff_runtime.base.effort import bounded_effort
from aff_runtime.base.errors import AffError, ConfigError
from aff_runtime.base.printable import printable
from aff_runtime.base.runs.table import few

LONGEST_S, MEMORY_BYTES = 600.0, 2 << 30
"""What reading one run may take: its files may be somebody else's."""
Say = Callable[[str], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class IngestedRuns:
    """What became of runs: ``refused`` of ``runs`` could not be read.

    ``notes`` : what stands out.
    """

    store: Store
    runs: int
    refused: int
    notes: tuple[str, ...] = ()


def ingest_runs(
    folder: Path, runs: Iterable[Path], say: Say, warn: Say, limits: Limits | None = None
) -> IngestedRuns:
    """Take what is new of runs into the store in ``folder``, and save it with what stands out.

    ``limits`` : sizes by roller and SI unit; None: those that were given last.

    Raises
    ------
    ConfigError
        The store cannot be read or written, or another command has it.
    """
    count = refused = 0
    with lock_store(folder):
        store = load_store(folder, begin=True)
        for one in runs:
            count += 1
            shown = printable(str(one))
            run, reads, ended = _read(one, store)
            if run is None or (ended and not reads):
                refused += 1
                warn(f"left out: {ended}")
                continue
            taken = store.add(run, reads)
            say(f"{shown}: {sentences.taken(taken)}")
            for lost in few(list(dict.fromkeys((*run.lost, *taken.lost)))) if taken.new else ():
                say(f"{shown}: {lost}")
            if taken.new:
                save_store(folder, store)
            if ended:
                warn(
                    f"not to its end: {ended} What was read of it is kept; the next "
                    "`aff-runtime watch add` goes on there"
                )
        notes: tuple[str, ...] = ()
        if store.line:
            save_store(folder, store)
            notes = _note(folder, store, limits)
    return IngestedRuns(store=store, runs=count, refused=refused, notes=notes)


def _read(folder: Path, store: Store) -> tuple[RunHours | None, list[HourRead], str]:
    """Return a run, those of its hours that were read, and why that ended early, else nothing.

    The store is not changed: what ends in the middle of an hour leaves no half of one.
    """
    run, reads = None, list[HourRead]()
    shown = printable(str(folder))
    try:
        with bounded_effort(shown, ConfigError, seconds=LONGEST_S, memory_bytes=MEMORY_BYTES):
            run = run_hours(folder)
            for one in store.unread(run):
                reads.append(run.read(one))
    except AffError as error:
        return run, reads, str(error)
    return run, reads, ""


def _note(folder: Path, store: Store, limits: Limits | None) -> tuple[str, ...]:
    """Leave what stands out beside the tables, for who does not read them; return it."""
    if limits is None:
        before = read_notes(folder)
        known = set(store.orders["roll"])  # less than before, where a store was begun anew
        given = {} if before is None else before.by_roller()
        limits = {key: size for key, size in given.items() if key[0] in known}
    at = wall_time_iso()
    found = tuple(sentences.notes(findings(store, limits, now=parse_utc(at))))
    kept = tuple((roll, unit, size) for (roll, unit), size in limits.items())
    write_notes(folder, WatchNotes(line=store.line, looked_utc=at, notes=found, limits=kept))
    return found


def exchange(folder: Path, roll: str, on: datetime, why: str) -> None:
    """Begin a new life of a roller in the store in ``folder``.

    Raises
    ------
    ConfigError
        There is no store, it knows no such roller, or another command has it.
    """
    load_store(folder)  # before a folder is made for one that is not there
    with lock_store(folder):
        store = load_store(folder)
        store.exchange(roll, on, printable(why, 200))
        save_store(folder, store)
        _note(folder, store, None)


def parse_utc(text: str) -> datetime:
    """Return a day or a moment, UTC where no zone is said.

    Raises
    ------
    ConfigError
        It is none.
    """
    try:
        found = datetime.fromisoformat(text)
    except ValueError:
        shown = printable(text, 40)
        raise ConfigError(
            f"read {shown!r}, expected a date such as 2026-03-02 or 2026-03-02T14:30"
        ) from None
    return found.astimezone(UTC) if found.tzinfo else found.replace(tzinfo=UTC)
