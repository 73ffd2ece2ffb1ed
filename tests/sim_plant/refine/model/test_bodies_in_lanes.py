"""Lines with dancer, oven and accumulator side by side beside the same ones one by one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sim_plant.lanes import library
from sim_plant.line.reading.load import load_declaration
from sim_plant.refine.model import cases_in_lanes
from sim_plant.refine.model.cases_in_lanes import attempt, simulated
from sim_plant.refine.model.twin import Case, Twin

LINE = load_declaration(Path(__file__).parents[4] / "config/lines/coater.yaml")
ROWS = 400
NUMBERS = (
    "dancers.dancer.load_N_m",
    "accumulators.accumulator.mass_kg",
    "heated_spans.oven.warming_K",
    "control.position_pi.dancer.gain_m_s_per_m",
)


@pytest.mark.parametrize("name", library.BUILDS)
def test_corrections_of_bodies_give_in_lanes_what_they_give_alone(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    lanes = library.loaded(name)
    if lanes is None:
        pytest.skip(f"no binary for {name} here, or not for this processor")
    monkeypatch.setattr(cases_in_lanes, "fitting", lambda _lines: lanes)
    at = np.arange(ROWS) * LINE.sample_time_s
    twin = Twin(
        declaration=LINE,
        channels=tuple(sensor.channel for sensor in LINE.sensors),
        speed_m_s=2.0 + 0.1 * np.sin(4.0 * at),
        tension_N=np.where(at > 1.0, 95.0, 90.0),
        aff_m_s={"unwind": 0.01 * np.sin(9.0 * at)},
    )
    cases = tuple(Case(shifts=((number, 0.02),)) for number in NUMBERS)
    together = simulated(twin, 0, cases[: lanes.width])
    for case, found in zip(cases, together, strict=False):
        alone = attempt(twin, case)
        moved = np.maximum(np.ptp(alone, axis=1), 1e-9)
        assert np.max(np.abs(found - alone) / moved[:, None]) < 1e-8
