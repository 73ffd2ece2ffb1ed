"""``aff-runtime check SITE.yaml``: validate without any I/O but reading."""

from __future__ import annotations

import argparse
import contextlib
from dataclasses import replace
from pathlib import Path
from typing import Any

from aff_runtime.app.check.record_size import record_line
from aff_runtime.app.check.validate import refused_at_start
from aff_runtime.base.arguments import speed_m_s
from aff_runtime.base.effort import bounded_effort
from aff_runtime.base.errors import AffError, ConfigError
from aff_runtime.cli.service import add_state_dir
from aff_runtime.cli.terminal import complain, say
from aff_runtime.config.check import check_site
from aff_runtime.core.compiled.binary import arithmetic_name


def add(commands: Any, service: argparse.ArgumentParser) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser("check", help="validate a site file; touches no network")
    parser.add_argument("site", type=Path, metavar="SITE.yaml")
    parser.add_argument(
        "--speed",
        type=speed_m_s,
        action="append",
        default=[],
        metavar="SPEED",
        help="line speed at which frequencies are shown: m/s, or with a unit such as '200 FPM'; "
        "may be repeated",
    )
    parser.add_argument(
        "--brief", action="store_true", help="only errors, warnings and the result"
    )
    add_state_dir(parser)
    parser.set_defaults(command=check)


def check(options: argparse.Namespace) -> int:
    """Print the report; 0 when the file may be used."""
    if any(not 0.0 < speed < float("inf") for speed in options.speed):
        complain("aff-runtime: --speed must be above 0 m/s")
        return 2
    with bounded_effort(str(options.site), ConfigError):
        report = check_site(options.site, tuple(options.speed), options.state_dir)
    if report.ok:
        with bounded_effort(str(options.site), ConfigError):
            report = replace(report, refused=refused_at_start(options.site, options.state_dir))
    if report.ok and report.site is not None and not options.brief:
        say(f"law by {arithmetic_name()}")
        with contextlib.suppress(AffError):  # what the rooms refuse, the service says
            say(record_line(report.site))
    for line in report.lines(brief=options.brief):
        (say if report.ok else complain)(line)
    return report.exit_code
