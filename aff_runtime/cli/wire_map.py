"""``aff-runtime map SITE.yaml``: what goes where on the wire; touches no network."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from aff_runtime.base.effort import bounded_effort
from aff_runtime.base.errors import ConfigError
from aff_runtime.cli.service import add_state_dir
from aff_runtime.cli.terminal import say
from aff_runtime.config.devices import load_device
from aff_runtime.config.loader import load_site
from aff_runtime.config.wire_table import wire_lines


def add(commands: Any, service: argparse.ArgumentParser) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser("map", help="show what goes where on the wire; no network")
    parser.add_argument("site", type=Path, metavar="SITE.yaml")
    parser.add_argument(
        "--device", action="store_true", help="the file is a device profile (config/devices)"
    )
    add_state_dir(parser)
    parser.set_defaults(command=show)


def show(options: argparse.Namespace) -> int:
    """Print the table."""
    with bounded_effort(str(options.site), ConfigError):
        if options.device:
            lines = load_device(options.site).lines()
        else:
            site = load_site(options.site, options.state_dir)
            lines = list(wire_lines(site, options.site.absolute().parent))
    for line in lines:
        say(line)
    return 0
