"""`sim-plant demo`: plant and runtime as two processes, before and after, one report."""

from __future__ import annotations

import argparse
import shlex
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from aff_runtime.base.errors import PlantError
from sim_plant.cli.output import say

if TYPE_CHECKING:
    from sim_plant.demo.session import DemoPlan

ROOT = Path(__file__).resolve().parents[2]
FPM_M_S = 0.00508
NOISE_N = 0.25
WIRES = ("modbus", "can", "canopen")
ROUNDING = 1e-6
ROUNDING_OF_FPM = 1e-5  # the Makefile writes 10 m/s as 1968.5 feet per minute
OF_MAKE = {
    "machine": "LINE",
    "wire": "WIRE",
    "site": "SITE",
    "speed_fpm": "SPEED",
    "limit_m_s": "LIMIT",
}
# a longer probe winds off more web: later the unwind 1x would meet that of the S-wrap when judged
LEARN_AFTER_LONG_PROBE_S = 35.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Machine:
    """A shipped line that the demo shows: its usual speed and the range that makes sense, m/s."""

    line: Path
    speed_m_s: float
    speeds_m_s: tuple[float, float]
    fast: bool = False


MACHINES = {
    "euclid": Machine(
        line=ROOT / "config/lines/euclid_ripple.yaml",
        speed_m_s=200.0 * FPM_M_S,
        speeds_m_s=(30.0 * FPM_M_S, 600.0 * FPM_M_S),
    ),
    "film": Machine(
        line=ROOT / "config/lines/film_ripple.yaml",
        speed_m_s=10.0,
        speeds_m_s=(5.0, 1000.0 / 60.0),
        fast=True,
    ),
}


def register(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command's arguments."""
    parser = subparsers.add_parser("demo", help="show the main job end to end on loopback")
    add_line(parser)
    parser.add_argument("--out", type=Path, default=Path("out/demo"))
    parser.add_argument("--seed", type=int, default=7)
    parser.set_defaults(run=run)


def add_line(parser: argparse.ArgumentParser) -> None:
    """Add which line is shown, by which wire and at which speed."""
    parser.add_argument("--machine", choices=tuple(MACHINES), default="euclid", help="which line")
    parser.add_argument("--line", type=Path, help="line file (the machine's own in config/lines)")
    parser.add_argument("--wire", choices=WIRES, default="modbus", help="how the two talk")
    parser.add_argument("--site", type=Path, help="site file (the wire's own in config/)")
    parser.add_argument("--speed-fpm", type=float, help="line speed, feet per minute")
    parser.add_argument(
        "--limit-m-s",
        type=float,
        help="limit of the unwind's correction, on both sides (the site file's own)",
    )


def run(arguments: argparse.Namespace) -> int:
    """Run the demo; 0 when every target is met, 5 when one is missed."""
    from sim_plant.demo.evaluation import TARGET_RIPPLE, evaluate, ripple_ratio, table_text, window  # noqa: PLC0415 - heavy imports
    from sim_plant.demo.processes import end_as_by_hand  # noqa: PLC0415
    from sim_plant.demo.report import write_report  # noqa: PLC0415
    from sim_plant.demo.session import run_session  # noqa: PLC0415

    machine = MACHINES[arguments.machine]
    plan = replace(plan_of(arguments), seed=arguments.seed)
    if arguments.limit_m_s is not None:
        plan = replace(plan, learn_s=LEARN_AFTER_LONG_PROBE_S)
    end_as_by_hand()
    session = run_session(plan, say)
    before = window(session.record, *session.before_s)
    after = window(session.record, *session.after_s)
    rows = evaluate(before, after, NOISE_N, fast=machine.fast)
    page = write_report(session, rows, NOISE_N)
    ratio = ripple_ratio(before, after)
    total = f"total ripple of the unwind tension: {ratio:.3f} of PI alone"
    say(f"\n{table_text(rows)}\n{total}\n\nreport: {page}")
    say(f"to look at the same line live: {live_command(arguments)}")
    quiet = not machine.fast or ratio <= TARGET_RIPPLE
    return 0 if quiet and all(row.passed for row in rows) else 5


def plan_of(arguments: argparse.Namespace) -> DemoPlan:
    """Return what to run of what ``add_line`` asked.

    Raises
    ------
    PlantError
        When the machine does not run at this speed, or has no site file for the wire.
    """
    from sim_plant.demo.session import DemoPlan  # noqa: PLC0415 - heavy imports
    from sim_plant.demo.wires import FILM_SITES, SITES  # noqa: PLC0415

    machine = MACHINES[arguments.machine]
    speed_m_s = machine.speed_m_s
    if arguments.speed_fpm is not None:
        speed_m_s = arguments.speed_fpm * FPM_M_S
    low, high = machine.speeds_m_s
    if not low * (1.0 - ROUNDING) <= speed_m_s <= high * (1.0 + ROUNDING):
        low_fpm, high_fpm = low / FPM_M_S, high / FPM_M_S
        raise PlantError(
            f"--speed-fpm {arguments.speed_fpm:g}: give {low_fpm:.0f} to {high_fpm:.0f} feet "
            "per minute"
        )
    sites = FILM_SITES if machine.fast else SITES
    if arguments.wire not in sites:
        raise PlantError(f"--wire {arguments.wire}: no site file of the {arguments.machine} line")
    site = arguments.site or ROOT / "config" / sites[arguments.wire]
    return DemoPlan(
        line=arguments.line or machine.line,
        site=site,
        out=arguments.out,
        wire=arguments.wire,
        line_speed_m_s=speed_m_s,
        limit_m_s=arguments.limit_m_s,
    )


def live_command(arguments: argparse.Namespace) -> str:
    """Return the command that shows the line of these arguments with its screen.

    `make hmi` where it is there and takes them; `sim-plant live` shows a line file of one's own,
    too. What is as by default is left out.
    """
    machine = MACHINES[arguments.machine]
    fpm = arguments.speed_fpm
    is_usual = fpm is None or abs(fpm * FPM_M_S / machine.speed_m_s - 1.0) < ROUNDING_OF_FPM
    given = {
        "machine": arguments.machine if arguments.machine != "euclid" else None,
        "line": arguments.line,
        "wire": arguments.wire if arguments.wire != WIRES[0] else None,
        "site": arguments.site,
        "speed_fpm": None if is_usual else f"{fpm:g}",
        "limit_m_s": None if arguments.limit_m_s is None else f"{arguments.limit_m_s:g}",
    }
    asked = {name: shlex.quote(str(value)) for name, value in given.items() if value is not None}
    if arguments.line is None and _is_at_home():
        return " ".join(["make hmi", *(f"{OF_MAKE[name]}={asked[name]}" for name in asked)])
    options = [f"--{name.replace('_', '-')} {value}" for name, value in asked.items()]
    return " ".join(["sim-plant live", *options])


def _is_at_home() -> bool:
    """Return whether `make` is asked in the folder of this project."""
    here = Path.cwd() / "Makefile"
    return here.is_file() and here.resolve() == ROOT / "Makefile"
