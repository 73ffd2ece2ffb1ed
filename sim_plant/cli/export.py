"""`sim-plant export`: a declared line for other simulators, as an FMU."""

from __future__ import annotations

import argparse
from pathlib import Path

from aff_runtime.base.errors import PlantError
from sim_plant.cli.output import say


def register(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command's arguments."""
    parser = subparsers.add_parser(
        "export",
        help="write a declared line as an FMU for other simulators",
        description="Write a line with its corrections and effects, settled at its references, as "
        "an FMU for co-simulation: C source, and a binary of this machine where it has a C "
        "compiler. docs/tester/fmu.md",
    )
    parser.add_argument("line", type=Path, metavar="LINE.yaml")
    parser.add_argument("--fmu", action="store_true", required=True, help="as an FMU")
    parser.add_argument("--out", type=Path, metavar="FILE.fmu", help="(LINE.fmu, here)")
    parser.add_argument("--fmi", choices=("2.0", "3.0"), default="3.0", help="version (3.0)")
    parser.add_argument("--source-only", action="store_true", help="no binary in it")
    parser.add_argument("--sample-time", type=float, metavar="S", help="s (declaration's)")
    parser.add_argument("--speed-m-s", type=float, help="line speed at the start (declaration's)")
    parser.add_argument("--tension-N", type=float, help="tension at the start (declaration's)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Settle the line and write the file."""
    from sim_plant.export.fmu import export_line, settled_line, write_fmu  # noqa: PLC0415
    from sim_plant.line.reading.load import load_declaration  # noqa: PLC0415 (heavy imports)

    out = arguments.out or Path(arguments.line.name).with_suffix(".fmu")
    if out.suffix != ".fmu":
        raise PlantError(f"--out {out}: importers want a name that ends with .fmu")
    if arguments.sample_time is not None and not arguments.sample_time > 0.0:
        raise PlantError(f"--sample-time {arguments.sample_time:g}: give more than 0 s")
    point = {"speed_m_s": arguments.speed_m_s, "tension_N": arguments.tension_N}
    line = settled_line(
        load_declaration(arguments.line), sample_time_s=arguments.sample_time, **point
    )
    export = export_line(line, arguments.line.stem, arguments.fmi, **point)
    folder = write_fmu(export, out, with_binary=not arguments.source_only)
    binary = f"binary for {folder}" if folder else "no binary"
    if folder is None and not arguments.source_only:
        binary += ": there is no C compiler here, or no name for this machine's binaries"
    counts = ", ".join(
        f"{len(export.interface.numbered(kind))} {kind}s"
        for kind in ("input", "output", "parameter")
    )
    say(
        f"FMI {export.version}, {counts}, step {line.sample_time_s:g} s; source and {binary}: "
        f"{out} ({out.stat().st_size / 1000:.0f} kB)"
    )
    return 0
