"""``aff-runtime compare``: two windows of runs, before and after, on one page."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from aff_runtime.base.effort import bounded_effort
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.runs.window import run_window
from aff_runtime.cli.terminal import say

PAGE, DATA = "compare.html", "compare.json"
LONGEST_S = 600.0
"""Runs may be somebody else's, with thousands of rolls in their site file."""
MEMORY_BYTES = 4 << 30
"""The largest two windows that are taken, and what is made of them."""


def add(commands: Any, _service: argparse.ArgumentParser) -> None:
    """Add the command to the parser."""
    text = "compare two windows of recorded runs: ripple per roll and order, with intervals"
    parser = commands.add_parser("compare", help=text)
    window = "RUN_DIR, or RUN_DIR@FROM..TO: seconds of its column time_s, m:s or h:m:s"
    parser.add_argument("before", metavar="RUN@A..B", help=window)
    parser.add_argument("after", metavar="RUN@C..D", help="the same, of this run or another")
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        metavar="DIR",
        help=f"folder for {PAGE} and {DATA} (default: here)",
    )
    parser.set_defaults(command=compare)


def compare(options: argparse.Namespace) -> int:
    """Write page and JSON, print the orders; 0 whatever they say."""
    from aff_runtime.app.report.comparison import comparing, page  # noqa: PLC0415
    from aff_runtime.base.files import replace_text  # noqa: PLC0415 - numpy is for this alone

    with bounded_effort("compare", ConfigError, seconds=LONGEST_S, memory_bytes=MEMORY_BYTES):
        found = comparing.compare(run_window(options.before), run_window(options.after))
    try:
        replace_text(options.out / PAGE, page.page(found))
        data = json.dumps(page.as_json(found), indent=1, allow_nan=False)
        replace_text(options.out / DATA, data + "\n")
    except OSError as error:
        raise ConfigError(
            f"--out {options.out}: cannot be written ({error.strerror}); give a folder of yours"
        ) from None
    for line in page.lines(found):
        say(line)
    say(options.out / PAGE)
    return 0
