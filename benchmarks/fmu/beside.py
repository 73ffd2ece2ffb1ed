"""One run through an FMU and through the kernel: what differs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from benchmarks.fmu.imported import Imported
from sim_plant.base.arrays import Array
from sim_plant.base.effects import Effect, Value
from sim_plant.export.fmu import export_line, write_fmu
from sim_plant.line.arrays.locations import candidate_locations
from sim_plant.line.declared.declaration import Declaration, EffectEntry
from sim_plant.line.running.simulation import LineSimulation


@dataclass(frozen=True, slots=True, kw_only=True)
class References:
    """Columns (samples,) of a run: both references, and a correction at the unwind."""

    speed_m_s: Array
    tension_N: Array
    unwind_m_s: Array


def moving_references(line: Declaration, samples: int) -> References:
    """Return a run with a step of speed, a step of tension and a sine on the unwind."""
    at, point = np.arange(samples, dtype=np.float64), line.operating_point
    return References(
        speed_m_s=np.where(at >= samples // 3, 1.1, 1.0) * point.line_speed_m_s,
        tension_N=np.where(at >= samples // 2, 1.1, 1.0) * point.tension_N,
        unwind_m_s=0.004 * np.sin(0.04 * at),
    )


def strengths(row: Effect, share: float = 0.02) -> dict[str, Value]:
    """Return an effect's parameters at a share of what is typical; an onset is at 0.5."""
    found: dict[str, Value] = {
        name: (1.0 - share) * float(given.default) + share * given.typical
        for name, given in row.accepts.items()
        if given.role == "strength"
    }
    return found | ({row.onset.moment: 0.5} if row.onset is not None else {})


def with_effect(line: Declaration, row: Effect, share: float = 0.02) -> Declaration:
    """Return a line with an effect at a place that it may have; see ``strengths``."""
    place = candidate_locations(line, row)[-1]
    entry = EffectEntry(effect=row.name, location=place, parameters=strengths(row, share))
    return line.model_copy(update={"effects": (entry,)})


def by_kernel(line: LineSimulation, given: References) -> dict[str, Array]:
    """Return the channels of the run, as the kernel has them; the line goes on to its end."""
    roller = line.declaration.rollers[0].name
    found = line.simulate(
        given.speed_m_s, given.tension_N, {roller: given.unwind_m_s}, speed_holds=True
    )
    names = [roller.name for roller in line.declaration.rollers]
    for k, name in enumerate(names[:-1]):
        found[f"spans.{name}_{names[k + 1]}.tension_N"] = found["span_tension_N"][:, k]
    del found["span_tension_N"], found["body_angle_rad"]
    return found


def by_fmu(fmu: Imported, line: Declaration, given: References) -> dict[str, Array]:
    """Return the same channels, read after each communication step of one sample."""
    names = _channels(line)
    step_s, rows = fmu.sample_time_s, [fmu.get(names)]
    for k in range(given.speed_m_s.size - 1):
        fmu.set(inputs_at(line, given, k))
        fmu.step(k * step_s, step_s)
        rows.append(fmu.get(names))
    table = np.array(rows)
    return {name: table[:, k] for k, name in enumerate(names)}


def inputs_at(line: Declaration, given: References, k: int) -> Mapping[str, float]:
    """Return the inputs of one sample by their names."""
    tension = float(given.tension_N[k])
    return {
        "line_speed_ref_m_s": float(given.speed_m_s[k]),
        **{f"tension_ref_{loop.loop}_N": tension for loop in line.control.tension_pi},
        f"aff_{line.rollers[0].name}_m_s": float(given.unwind_m_s[k]),
    }


def differences(mine: Mapping[str, Array], its: Mapping[str, Array]) -> dict[str, float]:
    """Return the largest difference of every channel that both have; the names are the same."""
    assert set(mine) == set(its), set(mine) ^ set(its)
    return {name: float(np.max(np.abs(mine[name] - its[name]))) for name in mine}


def _channels(line: Declaration) -> list[str]:
    recorded = [sensor.channel for sensor in line.sensors]
    names = [roller.name for roller in line.rollers]
    spans = [f"spans.{a}_{b}.tension_N" for a, b in pairwise(names)]
    return [*recorded, *(f"true_{name}" for name in recorded), *spans]


def exported(path: Path, line: LineSimulation, version: str) -> Path:
    """Write the FMU of a settled line and return its path."""
    write_fmu(export_line(line, path.stem, "3.0" if version == "3.0" else "2.0"), path)
    return path
