"""The translated kernel beside the kernel itself: every number the same."""

from __future__ import annotations

import ctypes
from pathlib import Path

import numpy as np
import pytest

from sim_plant.base.arrays import Array
from sim_plant.base.effects import Effect, Value
from sim_plant.codegen.write import scalar_source
from sim_plant.effects.catalogue import CATALOGUE
from sim_plant.line.arrays.locations import candidate_locations
from sim_plant.line.declared.declaration import EffectEntry
from sim_plant.line.open import make_line
from sim_plant.line.reading.load import load_declaration
from sim_plant.line.running.simulation import LineSimulation
from tests.sim_plant.codegen.compiling import (
    EXACT,
    compiled_library,
    copied,
    run_by_c,
    run_by_numba,
)

LINE = load_declaration(Path(__file__).parents[3] / "config/lines/euclid.yaml")
QUICK = {"eccentric_roller", "splice", "shaft_compliance_backlash", "viscoelastic_web"}


@pytest.fixture(scope="module")
def kernel(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    return compiled_library(tmp_path_factory.mktemp("scalar"), scalar_source(), *EXACT)


def strengths(row: Effect) -> dict[str, Value]:
    """Return an effect's parameters at a fiftieth of what is typical; an onset is at 0.5 s."""
    found = {
        name: 0.98 * float(given.default) + 0.02 * given.typical
        for name, given in row.accepts.items()
        if given.role == "strength"
    }
    onset = {row.onset.moment: 0.5} if row.onset is not None else {}
    return {**found, **onset}


def line_with(row: Effect, seed: int | None = 3) -> LineSimulation:
    """Return the shipped line with an effect at a place that it may have."""
    place = candidate_locations(LINE, row)[-1]
    entry = EffectEntry(effect=row.name, location=place, parameters=strengths(row))
    return make_line(LINE.model_copy(update={"effects": (entry,)}), seed=seed)


def references(line: LineSimulation, frames: int) -> tuple[Array, ...]:
    """Return line speed, tensions, corrections and noise of a run with steps in all of them."""
    rng = np.random.default_rng(17)
    at = np.arange(frames)
    speed = 1.0 + 0.1 * (at > frames // 3) + 0.02 * np.sin(0.05 * at)
    tension = 89.0 + 10.0 * (at > frames // 2)
    width = line.arrays.cells.size + line.arrays.drives.size * (1 + line.timing.ticks_per_frame)
    return (
        np.column_stack((speed, np.roll(speed, -1))),
        np.repeat(tension[:, None], line.arrays.loops.size, axis=1),
        0.004 * rng.standard_normal((frames, 2 * line.arrays.drives.size)),
        rng.standard_normal((frames, width))
        if line.arrays.timing["noisy"][0]
        else np.zeros((1, width)),
    )


@pytest.mark.parametrize(
    "row",
    [
        pytest.param(row, id=row.name, marks=() if row.name in QUICK else pytest.mark.long)
        for row in CATALOGUE
    ],
)
@pytest.mark.parametrize("seed", [3, None], ids=["noise", "exact"])
def test_each_effect_gives_the_kernels_numbers_to_the_last_bit(
    row: Effect, seed: int | None, kernel: ctypes.CDLL
) -> None:
    line = line_with(row, seed)
    other = copied(line)
    given = references(line, 800)
    assert np.array_equal(run_by_numba(line, given), run_by_c(kernel, other, given))
    for mine, its in zip(line.state, other.state, strict=True):
        assert np.array_equal(mine, its)
    assert np.isfinite(line.state.y).all()


@pytest.mark.parametrize("limits", ["loop", pytest.param("correction", marks=pytest.mark.long)])
def test_a_limit_of_a_part_of_the_reference_gives_the_kernels_numbers_too(
    limits: str, kernel: ctypes.CDLL
) -> None:
    limit = {"slew_m_s2": 0.02, "limits": limits}
    entry = EffectEntry(effect="rate_limit", location="unwind", parameters=limit)
    line = make_line(LINE.model_copy(update={"effects": (entry,)}), seed=3)
    free = make_line(LINE, seed=3)
    other, given = copied(line), references(line, 800)
    mine = run_by_numba(line, given)
    assert np.array_equal(mine, run_by_c(kernel, other, given))
    assert not np.allclose(mine, run_by_numba(free, given))


def test_the_source_allocates_nothing_and_takes_integers_of_a_fixed_width() -> None:
    source = scalar_source()
    assert not any(word in source for word in ("malloc", "alloca", " long ", "static double"))
    assert "int64_t" in source
