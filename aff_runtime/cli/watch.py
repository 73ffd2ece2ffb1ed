"""``aff-runtime watch add | trend | exchange``: one line over weeks, from the runs it recorded."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path
from typing import Any

from aff_runtime.base.clock import wall_time_iso
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.files import CLOSED_TEXT
from aff_runtime.base.printable import printable
from aff_runtime.base.runs.window import names_a_run
from aff_runtime.base.units import UnitError, read_number
from aff_runtime.cli.terminal import complain, say


def add(commands: Any, _service: argparse.ArgumentParser) -> None:
    """Add the command to the parser.

    ``_service`` : parent parser of the commands that talk to a service; these talk to none.
    """
    parser = commands.add_parser(
        "watch", help="what recorded runs say of each roller over weeks: trends, lives, limits"
    )
    acts = parser.add_subparsers(required=True, metavar="ACT")
    act = acts.add_parser("add", help="take what is new of runs into a store, and say what grows")
    _add_store(act)
    act.add_argument(
        "runs", type=Path, nargs="+", metavar="RUN_DIR", help="a run, or a folder of runs"
    )
    _add_limits(act)
    act.set_defaults(command=add_runs)
    act = acts.add_parser("trend", help="every trend that a store knows, and rolls of web by rank")
    _add_store(act)
    _add_limits(act)
    act.add_argument("--json", action="store_true", help="for programs, SI")
    act.set_defaults(command=trend)
    act = acts.add_parser("exchange", help="a roller was exchanged: it begins a new life")
    _add_store(act)
    act.add_argument("roll", metavar="ROLLER", help="as the site file names it")
    act.add_argument("--on", required=True, type=_day, metavar="DATE", help="2026-03-02[T14:30]")
    act.add_argument("--why", default="", metavar="TEXT", help="serial numbers, reason")
    act.set_defaults(command=exchange)


def _add_store(act: argparse.ArgumentParser) -> None:
    text = "folder of the line's store: hours, orders and exchanges as Parquet"
    act.add_argument("store", type=Path, metavar="STORE", help=text)


def _add_limits(act: argparse.ArgumentParser) -> None:
    act.add_argument(
        "--limit",
        type=_limit,
        action="append",
        default=[],
        metavar="ROLLER=SIZE",
        help="largest size of a roller's orders, with unit: 'r6=0.2 mm' (shape, stroke), "
        "'r6=2 N' (ripple); may be repeated. Default: what the site file lets the law use",
    )


def add_runs(options: argparse.Namespace) -> int:
    """Take runs into the store; 1 where none could be read."""
    from aff_runtime.app.report.watching import ingest  # noqa: PLC0415 - numpy, pyarrow

    limits = _limits(options.limit)
    runs = list(_runs(options.runs))
    taken = ingest.ingest_runs(options.store, runs, say, complain, limits or None)
    for line in taken.notes:
        say(line)
    return 1 if taken.refused == taken.runs else 0


def trend(options: argparse.Namespace) -> int:
    """Print what the store says: what to know first, then everything."""
    from aff_runtime.app.report.watching import findings, sentences  # noqa: PLC0415
    from aff_runtime.app.report.watching.ingest import parse_utc  # noqa: PLC0415
    from aff_runtime.app.report.watching.store import load_store  # noqa: PLC0415
    from aff_runtime.app.report.watching.suppliers import supplier_rankings  # noqa: PLC0415
    from aff_runtime.app.report.watching.wound_rolls import rankings  # noqa: PLC0415

    store = load_store(options.store)
    now = parse_utc(wall_time_iso())
    found = findings.findings(store, _limits(options.limit), now=now)
    unread = findings.unread(store, now=now)
    ranked = rankings(store)
    if options.json:
        say(sentences.as_json(store.line, found, supplier_rankings(ranked), unread))
        return 0
    for line in sentences.notes(found):
        say(line)
    for line in sentences.table(found):
        say(f"  {line}")
    for line in sentences.unread(unread):
        say(f"  {line}")
    for line in (*sentences.rolls(ranked), *sentences.suppliers(supplier_rankings(ranked))):
        say(line)
    if not found:
        say(
            "none of the rollers in place has been read yet: give `aff-runtime watch add` runs at "
            "a steady speed"
        )
    return 0


def exchange(options: argparse.Namespace) -> int:
    """Begin a new life of a roller."""
    from aff_runtime.app.report.watching import ingest  # noqa: PLC0415 - numpy, pyarrow

    ingest.exchange(options.store, options.roll, options.on, options.why)
    say(f"{printable(options.roll)}: a new life from {options.on:%Y-%m-%d %H:%M} UTC")
    return 0


def _limits(given: list[tuple[str, str, float]]) -> dict[tuple[str, str], float]:
    """Return sizes by roller and SI unit; ConfigError where one is given twice."""
    limits: dict[tuple[str, str], float] = {}
    for roll, unit, size in given:
        if (roll, unit) in limits:
            raise ConfigError(f"--limit: two limits of {printable(roll)} are in {unit}; give one")
        limits[roll, unit] = size
    return limits


def _runs(given: list[Path]) -> Iterator[Path]:
    """Yield the runs that are named, those of a folder of runs in the order of their names."""
    for path in given:
        if names_a_run(path) and not path.is_dir():
            folder = str(path).rpartition("@")[0]
            raise ConfigError(
                f"{printable(str(path))}: a part of a run; watch looks for the steady stretches "
                f"of each hour itself: give {printable(folder)}"
            )
        try:
            inside = sorted(p for p in path.iterdir() if names_a_run(p)) if path.is_dir() else []
        except PermissionError:
            raise ConfigError(f"{printable(str(path))}: {CLOSED_TEXT}") from None
        except OSError as error:
            raise ConfigError(f"{printable(str(path))}: {error.strerror}") from None
        yield from inside if inside and not names_a_run(path) else [path]


def _limit(text: str) -> tuple[str, str, float]:
    """Return roller, SI unit and size of ``ROLLER=SIZE``.

    Raises
    ------
    argparse.ArgumentTypeError
        It is none.
    """
    roll, _, size = text.partition("=")
    if not roll or not size or size.replace(".", "").isdigit():
        raise argparse.ArgumentTypeError(f"read {text!r}, expected ROLLER=SIZE such as r6=0.2mm")
    said = ""
    for unit in ("m", "N"):
        try:
            return roll, unit, read_number(size, unit)
        except UnitError as error:
            said = said or str(error)
    raise argparse.ArgumentTypeError(f"read {text!r}: {said}")


def _day(text: str) -> datetime:
    """Return a day or a moment, UTC where no zone is said.

    Raises
    ------
    argparse.ArgumentTypeError
        It is none.
    """
    from aff_runtime.app.report.watching.ingest import parse_utc  # noqa: PLC0415 - numpy, pyarrow

    try:
        return parse_utc(text)
    except ConfigError as error:
        raise argparse.ArgumentTypeError(str(error)) from None
