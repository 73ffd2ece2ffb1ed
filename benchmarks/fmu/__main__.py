"""``python -m benchmarks.fmu``: exported lines beside the kernel, as a page."""

from __future__ import annotations

import argparse
import platform
import subprocess
import sys
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path

from benchmarks.fmu.measure import (
    ROUNDS,
    SAMPLES,
    Difference,
    Sizes,
    Speeds,
    all_differences,
    difference_of,
    sizes,
    speeds,
)
from sim_plant.base.shipped import shipped
from sim_plant.export.binary import compiler
from sim_plant.export.fmu import settled_line
from sim_plant.line.reading.load import load_declaration

PAGE = Path(__file__).resolve().parents[2] / "docs" / "results" / "fmu.md"
LINES = ("euclid", "euclid_ripple", "film", "coater")
EFFECTS_ON = "euclid"
RUN, SHARE = 1000, 0.02


def page(
    found: Sequence[Sizes],
    rates: Sequence[Speeds],
    rows: Sequence[Difference],
    others: Mapping[str, Difference],
) -> str:
    """Return the page."""
    program = compiler() or ""
    asked = [program, "-dumpfullversion"]
    gcc = subprocess.run(asked, capture_output=True, text=True, check=False).stdout.strip()
    parts = [
        "# The line as an FMU, beside the kernel",
        "",
        "Written by `python -m benchmarks.fmu --docs` ([what the FMU is](../tester/fmu.md)). "
        f"{platform.machine()}, {Path(program).name} {gcc}, numba {version('numba')}, "
        f"FMPy {version('fmpy')}.",
        "",
        "## Size",
        "",
        "kB; parts as they are unpacked.",
        "",
        "| line | FMI | FMU | binary | sources | description |",
        "|---|---|---|---|---|---|",
        *(
            f"| {s.name} | {s.version} | {s.whole / 1e3:.0f} | {s.binary / 1e3:.0f} | "
            f"{s.sources / 1e3:.0f} | {s.description / 1e3:.0f} |"
            for s in found
        ),
        "",
        "## Speed",
        "",
        f"Microseconds of a core per sample: medians of {ROUNDS} rounds of {SAMPLES} samples "
        "that took turns in one process, without noise. *Each sample*: FMPy sets an input, "
        "steps and reads an output in Python every time.",
        "",
        "| line | `simulate()` | FMU, one step | ratio | FMU, each sample |",
        "|---|---|---|---|---|",
        *(
            f"| {s.name} | {s.simulate_us:.1f} | {s.one_step_us:.1f} | "
            f"{s.simulate_us / s.one_step_us:.2f} | {s.each_sample_us:.1f} |"
            for s in rates
        ),
        "",
        "## Difference",
        "",
        f"{RUN} samples with a step of speed, a step of tension and a sine on the unwind; each "
        "effect at its last place, a fiftieth of what is typical (all numbers of an effect at "
        "once). *Moved*: the most that it moves any tension of this run. *Difference*: the "
        "largest between FMU and kernel, of every recorded channel, its true twin and every "
        "span's tension; 0 is to the last bit.",
        "",
        "| effect | place | moved, N | difference |",
        "|---|---|---|---|",
        *(f"| {r.effect} | {r.place} | {r.moved_N:.3g} | {r.difference:.3g} |" for r in rows),
        "",
        f"The effects above are on {EFFECTS_ON}. Other lines, as they are declared, in the same "
        "run (`coater`: dancer, oven, accumulator):",
        "",
        "| line | difference |",
        "|---|---|",
        *(f"| {name} | {row.difference:.3g} |" for name, row in others.items()),
        "",
    ]
    return "\n".join(parts)


def main(arguments: list[str]) -> int:
    """Measure and write the page; 1 where a difference is not 0."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fmu")
    parser.add_argument("--out", type=Path, default=Path("out/fmu.md"))
    parser.add_argument("--docs", action="store_true", help="write docs/results/fmu.md")
    options = parser.parse_args(arguments)
    declared = {name: load_declaration(shipped(f"lines/{name}.yaml")) for name in LINES}
    found = [
        sizes(name, settled_line(line), fmi)
        for name, line in declared.items()
        for fmi in ("3.0", "2.0")
    ]
    rates = [speeds(name, line) for name, line in declared.items()]
    rows = []
    others = {n: difference_of(line, RUN) for n, line in declared.items() if n != EFFECTS_ON}
    for row in all_differences(declared[EFFECTS_ON], RUN, SHARE):
        print(f"{row.effect} {row.place}: moved {row.moved_N:.3g} N, {row.difference:.3g}")
        rows.append(row)
    target = PAGE if options.docs else options.out
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(page(found, rates, rows, others), encoding="utf-8")
    print(f"page: {target}")
    return 1 if any(row.difference for row in (*rows, *others.values())) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
