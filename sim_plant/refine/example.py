"""Two records of a line with an effect that its declaration does not have, to try refine on."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import yaml

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array
from sim_plant.effects import eccentric_roller
from sim_plant.line.declaration import Declaration, EffectEntry
from sim_plant.line.load import Source, line_in
from sim_plant.line.open import make_line

HIDDEN = EffectEntry(
    effect=eccentric_roller.EFFECT.name,
    location="R6",
    parameters={"eccentricity_m": 2.5e-4, "angle_rad": 1.0},
)
PLANS = {"a": (0.9, 1.3, 1), "b": (1.2, 0.8, 2)}
"""Speeds before and after a ramp, m/s, and seed."""


def references(samples: int, step_s: float, slow: float, fast: float) -> tuple[Array, Array]:
    """Return speed and tension references: two plateaus with a ramp, one tension step."""
    time_s = np.arange(samples) * step_s
    end = time_s[-1]
    speed = np.interp(time_s, [0.0, 0.55 * end, 0.62 * end, end], [slow, slow, fast, fast])
    tension = np.where(time_s < 0.8 * end, 88.96, 95.0)
    return speed, tension


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
        own = Declaration.model_validate(data)
        guilty = own.model_copy(update={"effects": (HIDDEN,)})
        samples = round(duration_s / 0.01)
        speed, tension = references(samples, 0.01, slow, fast)
        run = make_line(guilty, seed=seed, speed_m_s=slow, tension_N=float(tension[0]))
        run.settle()
        out = run.simulate(speed, tension)
        columns = {
            "time_s": np.arange(samples) * 0.01,
            "line_speed_ref_m_s": speed,
            "tension_ref_N": tension,
        }
        columns |= {s.channel: out[s.channel] for s in line.sensors}
        path = folder / f"example_{name}.csv"
        np.savetxt(
            path,
            np.column_stack(list(columns.values())),
            "%.7g",
            ",",
            header=",".join(columns),
            comments="",
        )
        side = path.with_suffix(".yaml")
        side.write_text(yaml.safe_dump(data, sort_keys=False), encoding="utf-8")
        paths.append(path)
    return paths[0], paths[1]
