"""``aff-runtime audit verify FILE``: whether a line of the audit is missing or was changed."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from aff_runtime.app.hand.audit import verify
from aff_runtime.cli.terminal import complain, say

EXIT_BROKEN = 5


def add(commands: Any, service: argparse.ArgumentParser) -> None:
    """Add the command to the parser."""
    del service  # it reads a file and asks nobody
    parser = commands.add_parser("audit", help="the audit of who commanded what from a screen")
    acts = parser.add_subparsers(required=True, metavar="ACT")
    act = acts.add_parser("verify", help="is the chain whole? exit code 5 when it is not")
    act.add_argument(
        "file", type=Path, metavar="FILE", help="audit.jsonl; its older files lie beside it"
    )
    act.set_defaults(command=run)


def run(options: argparse.Namespace) -> int:
    """Follow the chain; 5 when it does not hold."""
    chain = verify(options.file)
    if chain.wrong:
        complain(f"aff-runtime: {options.file}: the chain does not hold: {chain.wrong}")
        return EXIT_BROKEN
    lines = chain.last - chain.first + 1 if chain.last else 0
    begin = "from the first of all" if chain.first <= 1 else "what was before it is not here"
    say(f"{lines} lines, {chain.first} to {chain.last}, {begin}; newest {chain.newest}")
    return 0
