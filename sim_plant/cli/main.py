"""The `sim-plant` command: each subcommand is one file with a ``register(subparsers)``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence

from aff_runtime.base.errors import AffError
from sim_plant.cli import (
    demo,
    demo_loop,
    fleet,
    identify,
    live,
    refine,
    reproduce,
    serve,
    simulate,
    tell,
)
from sim_plant.cli.output import say

# a new subcommand is one more module in this row
COMMANDS = (demo, demo_loop, fleet, identify, live, refine, reproduce, serve, simulate, tell)


def build_parser() -> argparse.ArgumentParser:
    """Return the parser with every subcommand."""
    parser = argparse.ArgumentParser(prog="sim-plant", description="A web line on a wire.")
    subparsers = parser.add_subparsers(required=True, metavar="COMMAND")
    for command in COMMANDS:
        command.register(subparsers)
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Run one subcommand and return its exit code."""
    arguments = build_parser().parse_args(argv)
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
