"""`sim-plant simulate`: run a declared line and write a record that analysis reads."""

from __future__ import annotations

import argparse
from pathlib import Path

from aff_runtime.base.errors import PlantError
from sim_plant.cli.output import say


def register(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command's arguments."""
    parser = subparsers.add_parser("simulate", help="run a declared line and write a record")
    parser.add_argument("line", type=Path, metavar="LINE.yaml")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE.csv.gz")
    parser.add_argument("--duration", type=float, default=60.0, metavar="S")
    parser.add_argument("--speed-m-s", type=float, help="line speed, m/s (declaration's)")
    parser.add_argument("--tension-N", type=float, help="tension reference, N (declaration's)")
    parser.add_argument(
        "--references",
        type=Path,
        metavar="RECORD.csv.gz",
        help="take both references from a record",
    )
    parser.add_argument("--seed", type=int, default=0, help="of the noise")
    parser.add_argument("--exact", action="store_true", help="no noise, exact sensors")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Simulate and write; the columns are the declaration's channels and the references."""
    import numpy as np  # noqa: PLC0415 (heavy imports only when used)

    from sim_plant.line.open import make_line  # noqa: PLC0415
    from sim_plant.line.reading.load import load_declaration  # noqa: PLC0415
    from sim_plant.line.record_file import read_columns, write_columns  # noqa: PLC0415

    if not 0.0 < arguments.duration <= 86400.0:
        raise PlantError(f"--duration {arguments.duration:g}: give 0 to 86400 s")
    declaration = load_declaration(arguments.line)
    point = declaration.operating_point
    speed_m_s = point.line_speed_m_s if arguments.speed_m_s is None else arguments.speed_m_s
    tension_N = point.tension_N if arguments.tension_N is None else arguments.tension_N
    samples = round(arguments.duration / declaration.sample_time_s)
    speeds, tensions = np.full(samples, speed_m_s), np.full(samples, tension_N)
    if arguments.references is not None:
        needed = ("line_speed_ref_m_s", "tension_ref_N")
        columns = read_columns(arguments.references, needed)
        speeds, tensions = columns[needed[0]], columns[needed[1]]
    line = make_line(
        declaration,
        seed=None if arguments.exact else arguments.seed,
        speed_m_s=float(speeds[0]),
        tension_N=float(tensions[0]),
    )
    line.settle()
    channels = line.simulate(speeds, tensions)
    names = [sensor.channel for sensor in declaration.sensors]
    time_s = np.asarray(np.arange(speeds.size) * declaration.sample_time_s, dtype=np.float64)
    table = {"time_s": time_s}
    table |= {name: channels[name] for name in names}
    table |= {"line_speed_ref_m_s": speeds, "tension_ref_N": tensions}
    write_columns(arguments.out, table)
    say(f"{speeds.size} samples of {len(names)} channels: {arguments.out}")
    return 0
