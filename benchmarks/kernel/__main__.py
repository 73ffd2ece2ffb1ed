"""Measure a line's step one by one and side by side, in turns of one run; write a page."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from aff_runtime.base.clock import wall_time_iso
from benchmarks.kernel.peers import peers
from benchmarks.runtime.facts import FactRow, Section, machine
from benchmarks.runtime.page import markdown, text
from sim_plant.lanes import library
from sim_plant.lanes.side_by_side import SideBySide
from sim_plant.line.reading.load import load_declaration
from sim_plant.line.running.simulation import LineSimulation
from sim_plant.refine.model.cases_in_lanes import attempt, simulated
from sim_plant.refine.model.twin import Case, Twin

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "results" / "kernel.md"
RECORD_S = 60.0
TITLE = "The kernel side by side and beside its peers"
NOTE = (
    "The line of `config/lines/euclid.yaml`, a record of 60 s, steps of 5 ms as a search takes "
    "them; processor time per line and step, the best of the turns. One by one is numba."
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Way:
    """One way to do the same work, and how many lines' steps that are."""

    name: str
    work: Callable[[], object]
    steps: float


def line_twin() -> Twin:
    """Return the shipped line under a minute of references that move."""
    line = load_declaration(ROOT / "config" / "lines" / "euclid.yaml")
    at = np.arange(round(RECORD_S / line.sample_time_s)) * line.sample_time_s
    return Twin(
        declaration=line,
        channels=tuple(sensor.channel for sensor in line.sensors),
        speed_m_s=1.0 + 0.05 * np.sin(at),
        tension_N=np.where(at > 0.5 * RECORD_S, 94.0, 89.0),
        aff_m_s={},
    )


def cases(bodies: Sequence[int]) -> list[Case]:
    """Return eight cases, each with a ripple of the next of these bodies."""
    return [
        Case(ripples=((bodies[k % len(bodies)], 1 + k // len(bodies), 2e-5, 1e-5),))
        for k in range(8)
    ]


def kernels(twin: Twin, some: Sequence[Case]) -> list[Way]:
    """Return the run of the record alone, no preparation, for each binary and for numba."""
    lines = [twin.line(case) for case in some]
    steps = len(some) * twin.speed_m_s.size * float(lines[0].arrays.timing["substeps"][0])
    given = (twin.speed_m_s, twin.tension_N)
    found = [Way(name="one by one", work=lambda: [x.simulate(*given) for x in lines], steps=steps)]
    for build in library.BUILDS:
        lanes = library.loaded(build)
        if lanes is not None:
            work = partial(_together, twin, lanes, lines)
            found.append(Way(name=f"{build}, {lanes.width} side by side", work=work, steps=steps))
    return found


def _together(twin: Twin, lanes: library.Lanes, lines: Sequence[LineSimulation]) -> None:
    given, columns = twin.references(lines[0]), lines[0].measured(twin.channels).columns
    for first in range(0, len(lines), lanes.width):
        group = SideBySide(lanes.functions, lanes.width, lines[first : first + lanes.width])
        group.run(given, columns, lines[0].timing.frames_per_sample)


def whole(twin: Twin, some: Sequence[Case]) -> list[Way]:
    """Return what a search asks for: build the lines, settle them, run them, read channels."""
    steps = len(some) * (twin.speed_m_s.size + some[0].settle_s / twin.declaration.sample_time_s)
    return [
        Way(name="one by one", work=lambda: [attempt(twin, case) for case in some], steps=steps),
        Way(name="side by side", work=lambda: simulated(twin, 0, some), steps=steps),
    ]


def measured(title: str, note: str, ways: Sequence[Way], turns: int) -> Section:
    """Return the best processor time of each way, taken in turns, and its ratio to the first."""
    best = [float("inf")] * len(ways)
    for _ in range(turns + 1):
        for k, way in enumerate(ways):
            start = time.process_time()
            way.work()
            best[k] = min(best[k], time.process_time() - start)
    rows = tuple(
        FactRow(
            name=way.name,
            value=f"{took / way.steps * 1e9:.0f} ns",
            remark=f"{best[0] / took:.1f} x" if k else "",
        )
        for k, (way, took) in enumerate(zip(ways, best, strict=True))
    )
    return Section(title=title, note=note, rows=rows)


def main() -> None:
    """Take a minute or two; ``--docs`` writes docs/results/kernel.md."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.kernel")
    parser.add_argument("--docs", action="store_true", help=f"write {PAGE.relative_to(ROOT)}")
    parser.add_argument("--turns", type=int, default=5, help="turns of each way (default 5)")
    options = parser.parse_args()
    twin, alike, apart = line_twin(), cases([0]), cases(range(2, 10))
    sections = [
        machine(),
        measured("One shape, other sizes", NOTE, kernels(twin, alike), options.turns),
        measured(
            "A shape on another roller in each lane",
            "A tangent that one lane needs costs the time of all.",
            kernels(twin, apart),
            options.turns,
        ),
        measured(
            "As a search asks for them",
            "Lines built, settled for 10 s, run, channels read.",
            whole(twin, alike),
            options.turns,
        ),
        peers(),
    ]
    print(text(sections))
    if options.docs:
        command = "python -m benchmarks.kernel --docs"
        PAGE.write_text(
            markdown(sections, date=wall_time_iso(), title=TITLE, command=command),
            encoding="utf-8",
        )
        print(f"written: {PAGE}")


if __name__ == "__main__":
    main()
