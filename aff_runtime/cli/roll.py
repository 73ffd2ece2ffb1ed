"""``aff-runtime roll``: one page with every roll as it is known now, in mm."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

from aff_runtime.app.report.roll_page import page
from aff_runtime.app.report.status_answer import StatusAnswer
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.files import replace_text
from aff_runtime.cli.service import connect, status_of
from aff_runtime.cli.terminal import say

ATTEMPTS = 50


def add(commands: Any, service: argparse.ArgumentParser) -> None:
    """Add the command to the parser."""
    text = (
        "draw the rolls as they are known now, in mm, with the reduction of each order: one page"
    )
    parser = commands.add_parser("roll", parents=[service], help=text)
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("roll.html"),
        metavar="FILE.html",
        help="page to write (default roll.html)",
    )
    parser.set_defaults(command=roll)


def at_the_encoders_zero(status: Callable[[], StatusAnswer]) -> StatusAnswer:
    """Return a status of a tick with a fresh reading: a slow PLC has not one in every tick."""
    answer = status()
    for _ in range(ATTEMPTS):
        if any(block.encoder_deg is not None for block in answer.blocks):
            break
        answer = status()
    return answer


def roll(options: argparse.Namespace) -> int:
    """Write the page and print where."""
    client = connect(options)
    try:
        answer = at_the_encoders_zero(lambda: status_of(client))
    finally:
        client.close()
    try:
        replace_text(options.out, page(answer))
    except OSError as error:
        raise ConfigError(f"{options.out}: {error.strerror}") from None
    say(options.out)
    return 0
