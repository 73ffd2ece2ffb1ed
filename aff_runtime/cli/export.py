"""``aff-runtime export``: a recorded run, or a part of it, as one Parquet file with units."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from aff_runtime.base.effort import bounded_effort
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.runs.window import run_window
from aff_runtime.cli.terminal import complain, say

LONGEST_S = 600.0
MEMORY_BYTES = 4 << 30


def add(commands: Any, _service: argparse.ArgumentParser) -> None:
    """Add the command to the parser."""
    text = "a recorded run as one Parquet file for DuckDB or pandas, units in its metadata"
    parser = commands.add_parser("export", help=text)
    window = "RUN_DIR, or RUN_DIR@FROM..TO: seconds of its column time_s, m:s or h:m:s"
    parser.add_argument("run", metavar="RUN[@A..B]", help=window)
    parser.add_argument(
        "--out", type=Path, required=True, metavar="FILE.parquet", help="replaced whole"
    )
    parser.set_defaults(command=export)


def export(options: argparse.Namespace) -> int:
    """Write the file; say what the run has lost."""
    from aff_runtime.app.report.run_export import export_run  # noqa: PLC0415 - numpy, pyarrow

    with bounded_effort("export", ConfigError, seconds=LONGEST_S, memory_bytes=MEMORY_BYTES):
        rows, lost = export_run(run_window(options.run), options.out)
    for sentence in lost:
        complain(sentence)
    say(f"{options.out}: {rows} rows")
    return 0
