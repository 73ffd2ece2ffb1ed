"""Two records of a line with an effect that its declaration does not have, to try refine on."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import yaml

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array
from sim_plant.effects import eccentric_roller
from sim_plant.line.declared.declaration import Declaration, EffectEntry
from sim_plant.line.open import make_line
from sim_plant.line.reading.load import Source, line_in

HIDDEN = EffectEntry(
    effect=eccentric_roller.EFFECT.name,
    location="R6",
    parameters={"eccentricity_m": 2.5e-4, "angle_rad": 1.0},
)
"""What the records have and the line file lacks."""
FIRST_TENSION_N, SECOND_TENSION_N = 88.96, 95.0
"""Reference of the tension in the records, before and after a step."""
PLANS = {"a": (0.9, 1.3, 1), "b": (1.2, 0.8, 2)}
"""Per record: speeds before and after a ramp, m/s, and the seed of its noise."""


def references(
    samples: int, step_s: float, first_m_s: float, second_m_s: float
) -> tuple[Array, Array]:
    """Return speed (m/s) and tension (N) references: two plateaus with a ramp, one tension step.

    The tension steps from 20 lbf up.
    """
    time_s = np.arange(samples) * step_s
    end = time_s[-1]
    plateaus_m_s = [first_m_s, first_m_s, second_m_s, second_m_s]
    speed_m_s = np.interp(time_s, [0.0, 0.55 * end, 0.62 * end, end], plateaus_m_s)
    tension_N = np.where(time_s < 0.8 * end, FIRST_TENSION_N, SECOND_TENSION_N)
    return speed_m_s, tension_N


def simulated(
    line: Declaration,
    hidden: EffectEntry | None,
    speeds_m_s: tuple[float, float],
    duration_s: float,
    seed: int,
) -> dict[str, Array]:
    """Return the columns of a record of ``line`` with the effect ``hidden``, if there is one."""
    machine = line.model_copy(update={"effects": (hidden,)}) if hidden else line
    first_m_s, second_m_s = speeds_m_s
    samples = round(duration_s / line.sample_time_s)
    speed, tension = references(samples, line.sample_time_s, first_m_s, second_m_s)
    run = make_line(machine, seed=seed, speed_m_s=first_m_s, tension_N=float(tension[0]))
    run.settle()
    out = run.simulate(speed, tension)
    columns: dict[str, Array] = {
        "time_s": np.arange(samples, dtype=np.float64) * line.sample_time_s,
        "line_speed_ref_m_s": speed,
        "tension_ref_N": tension,
    }
    return columns | {s.channel: out[s.channel] for s in line.sensors}


def write_table(columns: dict[str, Array], path: Path) -> None:
    """Write columns as CSV, gzipped where the name ends so."""
    rows = np.column_stack(list(columns.values()))
    np.savetxt(path, rows, "%.7g", ",", header=",".join(columns), comments="")


def write_example(source: Source, folder: Path, duration_s: float = 60.0) -> tuple[Path, Path]:
    """Write ``example_a`` and ``example_b`` (CSV and sidecar) of a line; return the two records.

    Raises
    ------
    PlantError
        When the declaration cannot be used; nothing is written then.
    """
    line = line_in(source).declaration
    if HIDDEN.location not in {roller.name for roller in line.rollers}:
        raise PlantError(
            f"{source.path}: the example puts its effect on roller {HIDDEN.location}, which this "
            "line does not have; give RECORDs of your own, or config/lines/euclid.yaml"
        )
    folder.mkdir(parents=True, exist_ok=True)
    data = {**source.data, "sample_time_s": 0.01}
    data.pop("effects", None)
    paths = []
    for name, (slow, fast, seed) in PLANS.items():
        declared = Declaration.model_validate(data)
        path = folder / f"example_{name}.csv"
        write_table(simulated(declared, HIDDEN, (slow, fast), duration_s, seed), path)
        sidecar = path.with_suffix(".yaml")
        sidecar.write_text(yaml.safe_dump(data, sort_keys=False), encoding="utf-8")
        paths.append(path)
    return paths[0], paths[1]
