"""`sim-plant identify`: parameters of a line from its records, with intervals or a refusal."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from aff_runtime.base.errors import PlantError

if TYPE_CHECKING:
    from sim_plant.identify.driven_roller import DrivenRoller, Run

Subparsers = argparse._SubParsersAction  # noqa: SLF001 (argparse names it nowhere else)


def register(subparsers: Subparsers[argparse.ArgumentParser]) -> None:
    """Add the subcommand and its three kinds."""
    parser = subparsers.add_parser("identify", help="parameters from recorded data")
    kinds = parser.add_subparsers(required=True, metavar="KIND")
    for name, text in (
        ("inertia", "inertia of a driven roller without web, from run-up and coast-down"),
        ("driven-friction", "friction of a driven roller without web, from its coast-down"),
    ):
        kind = kinds.add_parser(name, help=text)
        kind.add_argument(
            "records",
            nargs="+",
            type=Path,
            metavar="RECORD",
            help="CSV with time_s, speed_rad_s, torque_N_m",
        )
        kind.add_argument("--inertia-kg-m2", type=float, help="known inertia; else identified")
        kind.set_defaults(run=run_driven, wanted=name)
    idler = kinds.add_parser("idler-friction", help="idler bearings, from two load cells")
    idler.add_argument(
        "records",
        nargs="+",
        type=Path,
        metavar="RECORD",
        help="CSV with time_s, a speed in m/s and two tensions",
    )
    idler.add_argument("--radius-m", type=float, default=0.0381, help="of the idlers")
    idler.add_argument("--idlers-between", type=int, default=5, help="the two load-cell rollers")
    idler.add_argument("--divisor", type=float, help="instead of idlers-between + 1 (source: 7)")
    idler.add_argument("--speed", default="line_speed_m_s", metavar="COLUMN")
    idler.add_argument("--downstream", default="unwind_tension_N", metavar="COLUMN")
    idler.add_argument("--upstream", default="r3_tension_N", metavar="COLUMN")
    idler.set_defaults(run=run_idler)


def run_driven(arguments: argparse.Namespace) -> int:
    """Print what the records of one driven roller tell."""
    from sim_plant.identify.driven_roller import fit_driven_roller  # noqa: PLC0415

    given = arguments.inertia_kg_m2
    if given is not None and not given > 0.0:
        raise PlantError(f"--inertia-kg-m2 {given}: write a number greater than 0")
    found = fit_driven_roller([_read_run(path) for path in arguments.records], given)
    for line in _driven_lines(found, arguments.wanted):
        print(line)
    return 0


def _driven_lines(found: DrivenRoller, wanted: str) -> list[str]:
    if wanted == "inertia":
        return [
            found.inertia_kg_m2.text(),
            f"tau t / w with friction neglected (2.29): {found.nominal_inertia_kg_m2:.6g} kg m2",
        ]
    return [
        found.constant_N_m.text(),
        found.viscous_N_m_s.text(),
        f"viscous term alone (2.31): {found.viscous_only_N_m_s:.6g} N m s/rad; rms of the fit "
        f"{found.viscous_only_residual_rad_s:.3g} rad/s, with the constant term "
        f"{found.residual_rad_s:.3g} rad/s",
    ]


def _read_run(path: Path) -> Run:
    import numpy as np  # noqa: PLC0415

    from sim_plant.identify.driven_roller import Run  # noqa: PLC0415
    from sim_plant.identify.record import read_record  # noqa: PLC0415

    record = read_record(path, ["time_s", "speed_rad_s", "torque_N_m"])
    steps = np.diff(record["time_s"])
    step = float(np.median(steps))
    if np.any(np.abs(steps - step) > 0.01 * step):
        raise PlantError(f"{path}: time_s is not even; record at a fixed rate")
    return Run(
        sample_time_s=step, speed_rad_s=record["speed_rad_s"], torque_N_m=record["torque_N_m"]
    )


def run_idler(arguments: argparse.Namespace) -> int:
    """Print idler friction from load-cell records at several speeds."""
    from sim_plant.identify.idler_friction import (  # noqa: PLC0415
        fit_idler_friction,
        plateaus,
        rollers_between_cells,
    )
    from sim_plant.identify.record import read_record  # noqa: PLC0415

    a = arguments
    divisor = a.divisor if a.divisor is not None else rollers_between_cells(a.idlers_between)
    if not (a.radius_m > 0.0 and divisor > 0.0):
        raise PlantError("--radius-m and --divisor: write numbers greater than 0")
    points = []
    for path in a.records:
        r = read_record(path, ["time_s", a.speed, a.downstream, a.upstream])
        points += plateaus(r["time_s"], r[a.speed], r[a.downstream], r[a.upstream], a.radius_m)
    found = fit_idler_friction(points, a.radius_m, divisor)
    print(f"{len(points)} steady speeds, divisor {divisor:g}")
    for omega, torque in zip(found.omega_rad_s, found.torque_N_m, strict=True):
        print(f"  {omega:8.3f} rad/s  {torque:.6f} N m")
    print(found.constant_N_m.text())
    print(found.viscous_N_m_s.text())
    return 0
