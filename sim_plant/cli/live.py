"""`sim-plant live`: plant, service and screen on loopback, to look at."""

from __future__ import annotations

import argparse
from pathlib import Path

from aff_runtime.base.errors import PlantError
from sim_plant.cli.demo import FPM_M_S, ROOT
from sim_plant.cli.output import say


def register(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command's arguments."""
    parser = subparsers.add_parser("live", help="a line to look at in a browser; ctrl-c ends it")
    parser.add_argument("--line", type=Path, default=ROOT / "config/lines/euclid_ripple.yaml")
    parser.add_argument("--site", type=Path, default=ROOT / "config/euclid.yaml")
    parser.add_argument("--out", type=Path, default=Path("out/hmi"))
    parser.add_argument("--speed-fpm", type=float, default=200.0, help="line speed, feet per min")
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
    from sim_plant.demo.session import Plan  # noqa: PLC0415

    if not 30.0 <= arguments.speed_fpm <= 600.0:
        raise PlantError(f"--speed-fpm {arguments.speed_fpm:g}: give 30 to 600 feet per minute")
    plan = Plan(
        line=arguments.line,
        site=arguments.site,
        out=arguments.out,
        line_speed_m_s=arguments.speed_fpm * FPM_M_S,
    )
    end_as_by_hand()
    try:
        hands_off, fresh = arguments.hands_off, arguments.fresh
        run_live(plan, say, listen=arguments.listen, hands_off=hands_off, fresh=fresh)
    except KeyboardInterrupt:
        say("ended")
    return 0
