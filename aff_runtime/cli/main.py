"""``aff-runtime``: one parser, one file per command, one place where errors become exit codes.

Exit codes: 0 ok, 2 configuration, 3 communication, 4 refused, 5 alarm.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from aff_runtime.app.link.runtime_directory import default_directory
from aff_runtime.base.errors import AffError
from aff_runtime.base.release import release_text
from aff_runtime.cli import (
    audit,
    card,
    check,
    compare,
    export,
    metrics,
    operate,
    probe,
    probe_map,
    roll,
    run,
    settings,
    setup,
    status,
    top,
    watch,
    wire_map,
)
from aff_runtime.cli.terminal import complain
from aff_runtime.core.compiled.binary import arithmetic_name

COMMANDS = (
    setup,
    check,
    run,
    operate,
    settings,
    status,
    top,
    roll,
    compare,
    watch,
    export,
    metrics,
    probe,
    probe_map,
    wire_map,
    audit,
    card,
)


def _version() -> str:
    """Return what ``--version`` says: number, commit, and what works the law out."""
    return f"%(prog)s {release_text()}, law by {arithmetic_name()}"


def build_parser() -> argparse.ArgumentParser:
    """Return the parser of all commands."""
    parser = argparse.ArgumentParser(
        prog="aff-runtime",
        description="Adaptive feed-forward beside the drives of a web line.",
        epilog="exit codes: 0 ok, 2 configuration, 3 communication, 4 refused, 5 alarm",
        formatter_class=argparse.RawDescriptionHelpFormatter,  # the version is one line
    )
    parser.add_argument("--version", action="version", version=_version())
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    service = argparse.ArgumentParser(add_help=False)
    service.add_argument(
        "--runtime-dir",
        type=Path,
        default=None,
        metavar="DIR",
        help=f"directory of the service's socket (default {default_directory()})",
    )
    for command in COMMANDS:
        command.add(commands, service)
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; return its exit code."""
    options = build_parser().parse_args(arguments)
    try:
        return int(options.command(options))
    except AffError as error:
        for line in f"aff-runtime: {error}".split("\n"):  # one finding per line
            complain(line)
        return error.exit_code
    except KeyboardInterrupt:
        return 130
    except BrokenPipeError:
        return 0


if __name__ == "__main__":
    sys.exit(main())
