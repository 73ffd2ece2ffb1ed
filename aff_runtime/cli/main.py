"""``aff-runtime``: one parser, one file per command, one place where errors become exit codes.

Exit codes: 0 ok, 2 configuration, 3 communication, 4 refused, 5 alarm.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

from aff_runtime.app.link.runtime_directory import default_directory
from aff_runtime.base.errors import AffError
from aff_runtime.base.files import CLOSED_TEXT
from aff_runtime.base.release import release_text
from aff_runtime.cli.terminal import complain, say

COMMANDS = {
    "setup": "setup",
    "check": "check",
    "run": "run",
    "arm": "operate",
    "bypass": "operate",
    "forget": "operate",
    "stop": "operate",
    "shadow": "operate",
    "settings": "settings",
    "status": "status",
    "top": "top",
    "roll": "roll",
    "compare": "compare",
    "watch": "watch",
    "export": "export",
    "metrics": "metrics",
    "probe": "probe",
    "probe-map": "probe_map",
    "map": "wire_map",
    "audit": "audit",
    "card": "card",
    "commission": "commission",
}
"""Each command and its module here, in the order of the help. A new command is one more row."""


class _Version(argparse.Action):
    """``--version``: number, commit, and what works the law out."""

    def __call__(self, parser: argparse.ArgumentParser, *_: Any, **__: Any) -> None:
        binary = import_module("aff_runtime.core.compiled.binary")  # numpy is for this alone
        say(f"{parser.prog} {release_text()}, law by {binary.arithmetic_name()}")
        parser.exit()


def build_parser(word: str = "") -> argparse.ArgumentParser:
    """Return the parser.

    Parameters
    ----------
    word : the command to parse; its module alone is imported. Any other word: all commands, for
        the help and for an error that names them.
    """
    parser = argparse.ArgumentParser(
        prog="aff-runtime",
        description="Adaptive feed-forward beside the drives of a web line.",
        epilog="exit codes: 0 ok, 2 configuration, 3 communication, 4 refused, 5 alarm",
        formatter_class=argparse.RawDescriptionHelpFormatter,  # the epilog is one line
    )
    parser.add_argument(
        "--version", action=_Version, nargs=0, help="show program's version number and exit"
    )
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    service = argparse.ArgumentParser(add_help=False)
    service.add_argument(
        "--runtime-dir",
        type=Path,
        default=None,
        metavar="DIR",
        help=f"directory of the service's socket (default {default_directory()})",
    )
    for module in dict.fromkeys([COMMANDS[word]] if word in COMMANDS else COMMANDS.values()):
        import_module(f"aff_runtime.cli.{module}").add(commands, service)
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; return its exit code."""
    words = sys.argv[1:] if arguments is None else list(arguments)
    options = build_parser(*words[:1]).parse_args(words)
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
    except OSError as error:  # of a file that a command did not reckon with
        if error.filename is None:
            raise
        why = CLOSED_TEXT if isinstance(error, PermissionError) else error.strerror
        complain(f"aff-runtime: {error.filename}: {why}")
        return AffError.exit_code


if __name__ == "__main__":
    sys.exit(main())
