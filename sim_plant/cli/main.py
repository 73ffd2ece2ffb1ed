"""The `sim-plant` command: each subcommand is one file with a ``register(subparsers)``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from importlib import import_module

from aff_runtime.base.errors import AffError
from sim_plant.cli.output import say

COMMANDS = {
    "demo": "demo",
    "demo-loop": "demo_loop",
    "export": "export",
    "fleet": "fleet",
    "identify": "identify",
    "live": "live",
    "refine": "refine",
    "reproduce": "reproduce",
    "serve": "serve",
    "simulate": "simulate",
    "tell": "tell",
}
"""Each command and its module here, in the order of the help. A new command is one more row."""


def build_parser(word: str = "") -> argparse.ArgumentParser:
    """Return the parser.

    Parameters
    ----------
    word : the command to parse; its module alone is imported. Any other word: all commands, for
        the help and for an error that names them.
    """
    parser = argparse.ArgumentParser(prog="sim-plant", description="A web line on a wire.")
    subparsers = parser.add_subparsers(required=True, metavar="COMMAND")
    for module in [COMMANDS[word]] if word in COMMANDS else COMMANDS.values():
        import_module(f"sim_plant.cli.{module}").register(subparsers)
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Run one subcommand and return its exit code."""
    words = sys.argv[1:] if argv is None else list(argv)
    arguments = build_parser(*words[:1]).parse_args(words)
    run: Callable[[argparse.Namespace], int] = arguments.run
    try:
        return run(arguments)
    except AffError as error:
        say(f"sim-plant: {error}", error=True)
        return error.exit_code
    except KeyboardInterrupt:
        print("sim-plant: stopped", file=sys.stderr)
        return 130


if __name__ == "__main__":
    sys.exit(main())
