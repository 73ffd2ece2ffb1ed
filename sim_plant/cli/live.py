"""`sim-plant live`: plant, service and screen on loopback, to look at."""

from __future__ import annotations

import argparse
from pathlib import Path

from aff_runtime.base.errors import PlantError
from sim_plant.cli.demo import WIRES, add_line, plan_of
from sim_plant.cli.output import say


def register(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command's arguments."""
    parser = subparsers.add_parser("live", help="a line to look at in a browser; ctrl-c ends it")
    add_line(parser)
    parser.add_argument("--out", type=Path, default=Path("out/hmi"))
    parser.add_argument("--listen", default="127.0.0.1:8480", metavar="ADDRESS:PORT")
    parser.add_argument(
        "--hands-off", action="store_true", help="neither probe nor arm: that is left to you"
    )
    parser.add_argument(
        "--fresh",
        action="store_true",
        help="without a site file: the line is commissioned at the screen",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run until interrupted."""
    from sim_plant.demo.live import run_live  # noqa: PLC0415 - heavy imports
    from sim_plant.demo.processes import end_as_by_hand  # noqa: PLC0415

    plan = plan_of(arguments)
    if arguments.fresh and plan.wire != WIRES[0]:
        raise PlantError(f"--fresh: a new line is commissioned by --wire {WIRES[0]} alone")
    end_as_by_hand()
    try:
        hands_off, fresh = arguments.hands_off, arguments.fresh
        run_live(plan, say, listen=arguments.listen, hands_off=hands_off, fresh=fresh)
    except KeyboardInterrupt:
        say("ended")
    return 0
