"""Size, speed and difference of exported lines."""

from __future__ import annotations

import statistics
import tempfile
import time
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.fmu.beside import (
    by_fmu,
    by_kernel,
    differences,
    exported,
    moving_references,
    with_effect,
)
from benchmarks.fmu.imported import Imported
from sim_plant.effects.catalogue import CATALOGUE
from sim_plant.export.fmu import settled_line
from sim_plant.line.declared.declaration import Declaration
from sim_plant.line.running.simulation import LineSimulation

SAMPLES, ROUNDS = 2000, 9


@dataclass(frozen=True, slots=True, kw_only=True)
class Sizes:
    """Bytes of one FMU: the whole, and its parts unpacked."""

    name: str
    version: str
    whole: int
    binary: int
    sources: int
    description: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Speeds:
    """Microseconds of a core per sample, medians of rounds that took turns."""

    name: str
    simulate_us: float
    one_step_us: float
    each_sample_us: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Difference:
    """One effect: by how much it moves the run, and the largest difference of any channel."""

    effect: str
    place: str
    moved_N: float
    difference: float


def sizes(name: str, line: LineSimulation, version: str) -> Sizes:
    """Export a line and weigh it."""
    with tempfile.TemporaryDirectory() as folder:
        path = exported(Path(folder) / f"{name}.fmu", line, version)
        with zipfile.ZipFile(path) as archive:
            parts = {entry.filename: entry.file_size for entry in archive.infolist()}
        return Sizes(
            name=name,
            version=version,
            whole=path.stat().st_size,
            binary=sum(size for part, size in parts.items() if part.startswith("binaries")),
            sources=sum(size for part, size in parts.items() if part.startswith("sources")),
            description=parts["modelDescription.xml"],
        )


def speeds(name: str, declared: Declaration) -> Speeds:
    """Run 2000 samples by ``simulate()``, in one communication step, and sample by sample."""
    line = settled_line(declared)
    step_s = line.sample_time_s
    given = moving_references(declared, SAMPLES)
    held = {"line_speed_ref_m_s": float(given.speed_m_s[0])}
    read = f"true_{next(s.channel for s in declared.sensors if s.channel.endswith('_N'))}"
    with tempfile.TemporaryDirectory() as folder:
        fmu = Imported(exported(Path(folder) / f"{name}.fmu", line, "3.0"))
        fmu.start()
        times: dict[str, list[float]] = {"simulate": [], "one": [], "each": []}
        now = 0
        by_kernel(line, given)  # compiled by now
        for _ in range(ROUNDS):
            begun = time.process_time()
            by_kernel(line, given)
            times["simulate"].append(time.process_time() - begun)
            begun = time.process_time()
            fmu.step(now * step_s, SAMPLES * step_s)
            times["one"].append(time.process_time() - begun)
            begun = time.process_time()
            for k in range(now + SAMPLES, now + 2 * SAMPLES):
                fmu.set(held)
                fmu.step(k * step_s, step_s)
                fmu.get([read])
            times["each"].append(time.process_time() - begun)
            now += 2 * SAMPLES
        fmu.close()
    found = {key: 1e6 * statistics.median(values) / SAMPLES for key, values in times.items()}
    return Speeds(
        name=name,
        simulate_us=found["simulate"],
        one_step_us=found["one"],
        each_sample_us=found["each"],
    )


def difference_of(declared: Declaration, samples: int) -> Difference:
    """Return the row of a line as it is declared."""
    return next(all_differences(declared, samples, 0.0))


def all_differences(declared: Declaration, samples: int, share: float) -> Iterator[Difference]:
    """Yield one row per effect, first of all the line without one."""
    given = moving_references(declared, samples)
    plain = by_kernel(settled_line(declared), given)
    for row in (None, *CATALOGUE):
        name = "none" if row is None else row.name
        line_file = declared if row is None else with_effect(declared, row, share)
        kernel = settled_line(line_file)
        with tempfile.TemporaryDirectory() as folder:
            fmu = Imported(exported(Path(folder) / "line.fmu", kernel, "3.0"))
        fmu.start()
        mine = by_kernel(kernel, given)
        found = differences(mine, by_fmu(fmu, line_file, given))
        fmu.close()
        moved = max(float(np.max(np.abs(mine[c] - plain[c]))) for c in mine if c.endswith("_N"))
        yield Difference(
            effect=name,
            place=line_file.effects[0].location if line_file.effects else "",
            moved_N=moved,
            difference=max(found.values()),
        )
