"""`sim-plant tell`: one command to the control socket of a plant that is being served."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

from aff_runtime.base.errors import PlantError
from sim_plant.servers.control_client import ask

Subparsers = argparse._SubParsersAction  # noqa: SLF001 (argparse names it nowhere else)


WORDS = (
    "status | history LAST_SAMPLES | roll | reset | value CHANNEL | set REFERENCE VALUE | "
    "set BIT 0 (or 1) | fault NAME | clear [NAME] | step SAMPLES (with --stepped); "
    "a wrong name lists all"
)


def register(subparsers: Subparsers[argparse.ArgumentParser]) -> None:
    """Add the subcommand."""
    parser = subparsers.add_parser(
        "tell", help="send a command to a served plant: status, roll, set, fault, clear, ..."
    )
    parser.add_argument("control", type=Path, metavar="SOCKET", help="serve's --control PATH")
    parser.add_argument("words", nargs="+", metavar="WORD", help=WORDS)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print the answer as JSON; 2 when the plant says it is an error."""
    answer = tell(arguments.control, " ".join(arguments.words))
    failed = "error" in answer
    print(json.dumps(answer, indent=1), file=sys.stderr if failed else sys.stdout)
    return PlantError.exit_code if failed else 0


def tell(control: Path, command: str) -> dict[str, Any]:
    """Return the answer of the plant whose control socket is ``control``.

    Raises
    ------
    PlantError
        Nobody serves the socket, or the answer is none.
    """
    try:
        return ask(control, command)
    except (OSError, ValueError) as error:
        raise PlantError(
            f"no plant answers at {control} ({error}); start it with serve --control {control}"
        ) from error
