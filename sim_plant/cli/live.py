"""`sim-plant live`: plant, service and screen on loopback, to look at."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from aff_runtime.base.errors import PlantError
from sim_plant.cli.demo import WIRES, add_line, plan_of
from sim_plant.cli.output import say

if TYPE_CHECKING:
    from sim_plant.demo.unusual_plants import UnusualPlant


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
    parser.add_argument(
        "--plant",
        metavar="NAME",
        help="of --fresh: a plant that is unlike the shipped one, such as 'low words first'; a "
        "wrong name lists all",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run until interrupted."""
    plant = plant_of(arguments)
    if plant is not None:
        arguments.wire = plant.wire
    plan = plan_of(arguments)
    from sim_plant.demo.live import run_live  # noqa: PLC0415 - heavy imports
    from sim_plant.demo.processes import end_as_by_hand  # noqa: PLC0415

    end_as_by_hand()
    try:
        hands_off, listen = arguments.hands_off, arguments.listen
        run_live(plan, say, listen=listen, hands_off=hands_off, fresh=plant)
    except KeyboardInterrupt:
        say("ended")
    return 0


def plant_of(arguments: argparse.Namespace) -> UnusualPlant | None:
    """Return the plant that is to be commissioned; None where there is a site file.

    Raises
    ------
    PlantError
        There is none of the name, or it goes with something else that was asked.
    """
    from sim_plant.demo.unusual_plants import PLANTS, UnusualPlant  # noqa: PLC0415 - YAML

    name, wire = arguments.plant, arguments.wire
    if name is None:
        return UnusualPlant(wire=wire) if arguments.fresh else None
    if not arguments.fresh:
        raise PlantError("--plant: a plant to commission; write --fresh too")
    if name not in PLANTS:
        raise PlantError(f"--plant {name}: known are {', '.join(PLANTS)}")
    plant = PLANTS[name]
    if wire not in (WIRES[0], plant.wire):
        raise PlantError(f"--plant {name}: is reached by --wire {plant.wire}")
    if arguments.limit_m_s is not None:
        raise PlantError(f"--plant {name}: has limits of its own; leave --limit-m-s out")
    return plant
