"""``aff-runtime metrics``: the service in the Prometheus text format, without a web server.

For the textfile collector of the node exporter: run by a timer, the file is replaced whole. When
no service answers it says ``aff_control_up 0`` and nothing else of the line.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from aff_runtime.app.report.metrics.exposition import exposition
from aff_runtime.app.report.metrics.readings import readings
from aff_runtime.app.report.watch_notes import STORE, notes_of
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import ConfigError, WireError
from aff_runtime.base.files import replace_text
from aff_runtime.cli.service import connect, status_of
from aff_runtime.cli.terminal import complain, say


def add(commands: Any, service: argparse.ArgumentParser) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "metrics", parents=[service], help="the service in numbers, for Prometheus"
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="FILE.prom",
        help="file of the textfile collector, replaced whole (default: the terminal)",
    )
    parser.add_argument(
        "--watch",
        type=Path,
        default=STORE,
        metavar="STORE",
        help="of `aff-runtime watch`, to count what it found (default: %(default)s)",
    )
    parser.add_argument(
        "--line",
        default="",
        metavar="NAME",
        help="a label `line` on every number: several lines of one gateway in one collector",
    )
    parser.set_defaults(command=metrics)


def metrics(options: argparse.Namespace) -> int:
    """Print or write the metrics; 3 when no service answers."""
    answer, exit_code = None, 0
    try:
        client = connect(options)
        try:
            answer = status_of(client)
        finally:
            client.close()
    except WireError as error:
        complain(f"aff-runtime: {error}")
        exit_code = error.exit_code
    notes = None if answer is None else notes_of(options.watch, answer.line)
    text = exposition(readings(answer, MonotonicClock().now_ns(), notes), line=options.line)
    if options.out is not None:
        write(options.out, text)
    else:
        for line in text.splitlines():
            say(line)
    return exit_code


def write(path: Path, text: str) -> None:
    """Replace the collector's file whole.

    Raises
    ------
    ConfigError
        When it cannot be written.
    """
    try:
        replace_text(path, text)
    except OSError as error:
        reason = error.strerror or error
        raise ConfigError(f"{path}: cannot be written ({reason}); name another --out") from None
