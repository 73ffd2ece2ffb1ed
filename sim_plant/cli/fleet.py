"""`sim-plant fleet`: the runs of many lines refined side by side, one table."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from aff_runtime.base.errors import PlantError
from sim_plant.cli.output import say

if TYPE_CHECKING:
    from sim_plant.fleet.pipeline import FleetPlan

NIGHT_S = 10.0 * 3600.0
Subparsers = argparse._SubParsersAction  # noqa: SLF001 (argparse names it nowhere else)


def register(subparsers: Subparsers[argparse.ArgumentParser]) -> None:
    """Add the subcommand."""
    parser = subparsers.add_parser(
        "fleet",
        help="refine the records of many lines, one table of what they lack",
        description="Refine every two records of every line that have no row yet; write "
        "fleet.parquet, fleet.html and a report per look. docs/engineer/fleet.md",
    )
    parser.add_argument("lines", type=Path, metavar="LINES", help="folder of files NAME.yaml")
    parser.add_argument(
        "--runs",
        type=Path,
        required=True,
        metavar="RUNS",
        help="folder with a folder NAME per line: its records by name in the order of time",
    )
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="where rows go")
    parser.add_argument("--workers", type=int, default=2, help="of a cluster made here (2)")
    parser.add_argument(
        "--scheduler", default="", metavar="tcp://HOST:PORT", help="a Dask cluster that runs"
    )
    parser.add_argument("--limit-s", type=float, default=None, help="for one look (3600)")
    parser.add_argument(
        "--most", type=int, default=None, metavar="N", help="refine N looks, leave the rest"
    )
    parser.add_argument(
        "--example",
        type=int,
        default=0,
        metavar="N",
        help="first make N virtual lines with drawn effects in LINES and RUNS",
    )
    parser.add_argument("--seed", type=int, default=1, help="of the example")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Do the night's work; 0 when every look has a row, 1 when some were lost."""
    from sim_plant.fleet.example import write_fleet  # noqa: PLC0415 - heavy imports
    from sim_plant.fleet.pipeline import TABLE, refine_fleet  # noqa: PLC0415

    plan = plan_of(arguments)
    if arguments.example:
        write_fleet(arguments.example, arguments.seed, plan.lines, plan.runs, say)
    outcome = refine_fleet(plan, say)
    for found in outcome.findings:
        place = f" at {found.place}" if found.place else ""
        size = f", {found.number} {found.size:.4g} {found.unit}" if found.number else ""
        say(f"{found.line} {found.recorded} {found.verdict}: {found.effect}{place}{size}")
    say(f"{len(outcome.findings)} rows in {plan.out / TABLE}; {len(outcome.lost)} looks lost")
    if outcome.refined:
        night = NIGHT_S * outcome.refined / outcome.wall_s
        say(
            f"{outcome.refined} looks in {outcome.wall_s:.0f} s, each {outcome.each_s:.0f} s; "
            f"at this pace {night:.0f} in a night of {NIGHT_S / 3600:.0f} h"
        )
    if outcome.waiting:
        say(f"{outcome.waiting} looks wait; the same command goes on")
    return 1 if outcome.lost else 0


def plan_of(arguments: argparse.Namespace) -> FleetPlan:
    """Return what the command line asks for.

    Raises
    ------
    PlantError
        When a number makes no sense.
    """
    from sim_plant.fleet.pipeline import LIMIT_S, FleetPlan  # noqa: PLC0415 - heavy imports

    limit_s = LIMIT_S if arguments.limit_s is None else arguments.limit_s
    most = 1 if arguments.most is None else arguments.most
    given = (("--workers", arguments.workers), ("--limit-s", limit_s), ("--most", most))
    for name, value in given:
        if value <= 0:
            raise PlantError(f"{name} {value}: give more than 0")
    if arguments.example < 0:
        raise PlantError(f"--example {arguments.example}: give a number of lines")
    return FleetPlan(
        lines=arguments.lines,
        runs=arguments.runs,
        out=arguments.out,
        workers=arguments.workers,
        scheduler=arguments.scheduler,
        limit_s=limit_s,
        most=arguments.most,
    )
