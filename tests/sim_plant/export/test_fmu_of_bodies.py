"""A line with dancer, oven and accumulator as an FMU: the kernel's numbers to the last bit."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from sim_plant.export.binary import compiler
from sim_plant.export.fmu import export_line, settled_line
from sim_plant.line.reading.load import load_declaration

pytest.importorskip("fmpy", reason="FMPy, of the extra dev, runs the FMUs")
from fmpy.validation import validate_fmu

from benchmarks.fmu.beside import by_fmu, by_kernel, differences, exported, moving_references
from benchmarks.fmu.imported import Imported

pytestmark = pytest.mark.skipif(compiler() is None, reason="no C compiler on this machine")
LINE = load_declaration(Path(__file__).parents[3] / "config" / "lines" / "coater.yaml")
SEEN = [
    "true_dancer_position_m",
    "accumulators.accumulator.travel_now_m",
    "true_oven_tension_N",
    "true_rewind_tension_N",
]


compiles = [pytest.param(version, marks=pytest.mark.long) for version in ("3.0", "2.0")]


@pytest.fixture(scope="module", params=compiles)
def fmu(tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest) -> Path:
    folder = tmp_path_factory.mktemp("fmu")
    return exported(folder / "coater.fmu", settled_line(LINE), request.param)


@pytest.fixture
def line(fmu: Path) -> Iterator[Imported]:
    made = Imported(fmu)
    yield made
    made.close()


def test_dancer_oven_and_accumulator_are_among_its_variables() -> None:
    export = export_line(settled_line(LINE), "coater", "3.0")
    units = {variable.name: variable.unit for variable in export.interface.variables}
    assert [units[name] for name in SEEN] == ["m", "m", "N", "N"]
    assert {"travel_accumulator_m_s", "dancers.dancer.along_load_N"} <= set(units)


def test_fmpy_finds_no_problem(fmu: Path) -> None:
    assert validate_fmu(str(fmu)) == []


def test_a_run_with_steps_and_a_sine_is_the_kernels_to_the_last_bit(line: Imported) -> None:
    given = moving_references(LINE, 600)
    line.start()
    found = by_fmu(line, LINE, given)
    kernel = by_kernel(settled_line(LINE), given)
    assert np.ptp(found["true_dancer_position_m"]) > 1e-3
    assert set(differences(found, kernel).values()) == {0.0}


def test_an_accumulator_is_filled_by_its_input_as_the_lines_own(line: Imported) -> None:
    mine, rows, wanted = settled_line(LINE), [], []
    line.start()
    for k in range(300):
        line.set({"travel_accumulator_m_s": 0.01})
        line.step(k * LINE.sample_time_s, LINE.sample_time_s)
        rows.append(line.get(SEEN))
        found = mine.step({"travel_accumulator_m_s": 0.01})
        found["accumulators.accumulator.travel_now_m"] = found["true_accumulator_position_m"]
        wanted.append([found[name] for name in SEEN])
    assert np.array_equal(np.array(rows), np.array(wanted))
    assert rows[-1][1] > 0.01


def _travels(line: Imported, samples: int) -> list[float]:
    found = []
    for k in range(samples):
        line.step(k * LINE.sample_time_s, LINE.sample_time_s)
        found += line.get([SEEN[1]])
    return found


def test_an_accumulator_that_moves_from_the_start_begins_where_the_line_file_puts_it(
    line: Imported,
) -> None:
    mine, speed = settled_line(LINE), {"travel_accumulator_m_s": 0.01}
    wanted = [mine.step(speed)["true_accumulator_position_m"] for _ in range(100)]
    line.set(speed)
    line.start()
    assert _travels(line, 100) == wanted


def test_an_accumulator_that_moves_stands_while_a_changed_line_settles(line: Imported) -> None:
    """As one that begins to move behind the start; 40 s at 10 mm/s would be 0.4 m."""
    load, speed = {"dancers.dancer.along_load_N": 150.0}, {"travel_accumulator_m_s": 0.01}
    line.set(load)
    line.start()
    assert line.get([SEEN[1]]) == [pytest.approx(0.0, abs=1e-6)]
    line.set(speed)
    wanted = _travels(line, 200)
    line.reset()
    line.set(load | speed)
    line.start()
    assert _travels(line, 200) == wanted


def test_another_load_of_the_dancer_settles_the_line_at_another_tension(line: Imported) -> None:
    """2 T arm = load + weight arm: 10 N more along the travel are 5 N more of tension."""
    line.set({"dancers.dancer.along_load_N": 70.0 / 0.5 + 10.0})
    line.start()
    changed = line.get(["spans.R1_D1.tension_N", "spans.D1_R2.tension_N"])
    assert np.mean(changed) == pytest.approx(95.0, abs=0.1)
