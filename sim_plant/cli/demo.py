"""`sim-plant demo`: plant and runtime as two processes, before and after, one report."""

from __future__ import annotations

import argparse
from pathlib import Path

from aff_runtime.base.errors import PlantError
from sim_plant.cli.output import say

ROOT = Path(__file__).resolve().parents[2]
FPM_M_S = 0.00508
NOISE_N = 0.25
WIRES = ("modbus", "can", "canopen")


def register(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command's arguments."""
    parser = subparsers.add_parser("demo", help="show the main job end to end on loopback")
    parser.add_argument("--line", type=Path, default=ROOT / "config/lines/euclid_ripple.yaml")
    parser.add_argument("--wire", choices=WIRES, default="modbus", help="how the two talk")
    parser.add_argument("--site", type=Path, help="site file (the wire's own in config/)")
    parser.add_argument("--out", type=Path, default=Path("out/demo"))
    parser.add_argument("--speed-fpm", type=float, default=200.0, help="line speed, feet per min")
    parser.add_argument("--seed", type=int, default=7)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the demo; 0 when every target is met, 5 when one is missed."""
    from sim_plant.demo.evaluation import evaluate, table_text, window  # noqa: PLC0415 - heavy imports
    from sim_plant.demo.report import write_report  # noqa: PLC0415
    from sim_plant.demo.session import Plan, run_session  # noqa: PLC0415
    from sim_plant.demo.wires import SITES  # noqa: PLC0415

    if not 30.0 <= arguments.speed_fpm <= 600.0:
        raise PlantError(f"--speed-fpm {arguments.speed_fpm:g}: give 30 to 600 feet per minute")
    site = arguments.site or ROOT / "config" / SITES[arguments.wire]
    plan = Plan(
        line=arguments.line,
        site=site,
        out=arguments.out,
        wire=arguments.wire,
        line_speed_m_s=arguments.speed_fpm * FPM_M_S,
        seed=arguments.seed,
    )
    session = run_session(plan, say)
    rows = evaluate(
        window(session.record, *session.before_s),
        window(session.record, *session.after_s),
        NOISE_N,
    )
    page = write_report(session, rows, NOISE_N)
    say(f"\n{table_text(rows)}\n\nreport: {page}\nto look at such a line live: make hmi")
    return 0 if all(row.passed for row in rows) else 5
