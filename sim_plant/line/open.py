"""From a file to a running line."""

from __future__ import annotations

from pathlib import Path

from sim_plant.line.arrays.build import build_arrays, timing_of
from sim_plant.line.arrays.corrections import apply_corrections
from sim_plant.line.arrays.with_effects import apply_effects
from sim_plant.line.declared.declaration import Declaration
from sim_plant.line.reading.load import load_declaration
from sim_plant.line.rest.fastest_mode import ACCURATE_STEP, fastest_mode, substeps_for
from sim_plant.line.running.simulation import LineSimulation


def make_line(
    declaration: Declaration,
    *,
    seed: int | None = 0,
    sample_time_s: float | None = None,
    speed_m_s: float | None = None,
    tension_N: float | None = None,
    substeps: int = 1,
    effects: bool = True,
) -> LineSimulation:
    """Return a line with its declared corrections and effects, not settled yet.

    A drive tick has at least as many ``substeps`` as the declaration's fastest mode takes.

    Raises
    ------
    PlantError
        When an effect cannot be put on this line, or no sensible step follows it.
    """
    timing = timing_of(declaration, sample_time_s or declaration.sample_time_s)
    arrays = build_arrays(declaration, timing, substeps)
    arrays = apply_corrections(declaration, arrays, declaration.corrections)
    if effects:
        arrays = apply_effects(declaration, arrays, declaration.effects)
    made = LineSimulation(
        declaration,
        sample_time_s=sample_time_s,
        seed=seed,
        arrays=arrays,
        line_speed_m_s=speed_m_s,
        tension_N=tension_N,
    )
    mode = fastest_mode(declaration, arrays, made.lengths_m)
    wanted = substeps_for(mode, timing.drive_tick_s, ACCURATE_STEP)
    arrays.timing["substeps"] = max(substeps, wanted)
    return made


def open_line(
    path: str | Path,
    *,
    seed: int | None = 0,
    sample_time_s: float | None = None,
    speed_m_s: float | None = None,
    tension_N: float | None = None,
) -> LineSimulation:
    """Return the line in ``path``, settled at its operating point or at the one given.

    Raises
    ------
    PlantError
        When the declaration is wrong.
    """
    line = make_line(
        load_declaration(path),
        seed=seed,
        sample_time_s=sample_time_s,
        speed_m_s=speed_m_s,
        tension_N=tension_N,
    )
    line.settle()
    return line
