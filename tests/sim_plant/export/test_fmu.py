"""An exported line is a valid FMU, and gives the kernel's numbers to the last bit."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from sim_plant.base.effects import Effect
from sim_plant.effects.catalogue import CATALOGUE
from sim_plant.export.binary import compiler
from sim_plant.export.fmu import export_line, settled_line, write_fmu
from sim_plant.line.reading.load import load_declaration

pytest.importorskip("fmpy", reason="FMPy, of the extra dev, runs the FMUs")
from fmpy import simulate_fmu
from fmpy.build import build_platform_binary
from fmpy.validation import validate_fmu

from benchmarks.fmu.beside import (
    by_fmu,
    by_kernel,
    differences,
    exported,
    moving_references,
    with_effect,
)
from benchmarks.fmu.imported import Imported

pytestmark = pytest.mark.skipif(compiler() is None, reason="no C compiler on this machine")
LINES = Path(__file__).parents[3] / "config" / "lines"
LINE = load_declaration(LINES / "euclid.yaml")


@pytest.fixture
def line(fmu: Path) -> Iterator[Imported]:
    made = Imported(fmu)
    yield made
    made.close()


@pytest.mark.long  # its look takes 3 s; quick: FMPy reads and runs it
def test_fmpy_finds_no_problem_and_the_file_is_small(fmu: Path) -> None:
    assert validate_fmu(str(fmu)) == []
    assert fmu.stat().st_size < 1_000_000


def test_a_quiet_run_with_steps_and_a_sine_is_the_kernels_to_the_last_bit(line: Imported) -> None:
    given = moving_references(LINE, 1500)
    line.start()
    mine = by_kernel(settled_line(LINE), given)
    found = differences(mine, by_fmu(line, LINE, given))
    assert set(found.values()) == {0.0}, found
    assert np.ptp(mine["unwind_tension_N"]) > 5.0


@pytest.mark.long  # quick: the same translation in codegen/test_scalar.py
@pytest.mark.parametrize("row", [pytest.param(row, id=row.name) for row in CATALOGUE])
def test_each_effect_is_the_kernels_to_the_last_bit(row: Effect, tmp_path: Path) -> None:
    declared = with_effect(LINE, row)
    kernel, given = settled_line(declared), moving_references(LINE, 600)
    other = Imported(exported(tmp_path / "effect.fmu", kernel, "3.0"))
    other.start()
    found = differences(by_kernel(kernel, given), by_fmu(other, declared, given))
    other.close()
    assert set(found.values()) == {0.0}, found


def test_fmpy_simulates_it_as_any_other_and_its_outputs_are_the_kernels(fmu: Path) -> None:
    given = moving_references(LINE, 300)
    time_s = np.arange(300) * LINE.sample_time_s
    signals = np.array(
        list(zip(time_s, given.speed_m_s, given.unwind_m_s, strict=True)),
        dtype=[("time", "f8"), ("line_speed_ref_m_s", "f8"), ("aff_unwind_m_s", "f8")],
    )
    found = simulate_fmu(
        str(fmu),
        stop_time=float(time_s[-1]),
        output_interval=LINE.sample_time_s,
        input=signals,
        output=["true_unwind_tension_N"],
    )
    given = moving_references(LINE, 300)
    steady = type(given)(
        speed_m_s=given.speed_m_s,
        tension_N=np.full(300, LINE.operating_point.tension_N),
        unwind_m_s=given.unwind_m_s,
    )
    mine = by_kernel(settled_line(LINE), steady)["true_unwind_tension_N"]
    assert np.max(np.abs(found["true_unwind_tension_N"] - mine)) == 0.0


@pytest.mark.long  # quick: its binary is compiled from this source
def test_an_importer_compiles_it_from_its_source(fmu: Path, tmp_path: Path) -> None:
    folder = tmp_path / "unpacked"
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(folder)
    (binary,) = folder.glob("binaries/*/euclid.so")
    binary.unlink()
    work = tmp_path / "build"
    work.mkdir()
    build_platform_binary(str(folder), build_dir=str(work), configuration="Release")
    assert binary.exists()
    found = simulate_fmu(str(folder), stop_time=0.1, output=["unwind_tension_N"])
    start = settled_line(LINE).readings()["unwind_tension_N"]
    assert found["unwind_tension_N"][0] == start


def test_two_exports_of_the_source_are_the_same_bytes(tmp_path: Path) -> None:
    line, paths = settled_line(LINE), [tmp_path / name for name in ("one.fmu", "other.fmu")]
    for path in paths:
        write_fmu(export_line(line, "euclid", "3.0"), path, with_binary=False)
    assert paths[0].read_bytes() == paths[1].read_bytes()


@pytest.mark.long  # quick: of the source, above
def test_two_exports_are_the_same_bytes(fmu: Path, tmp_path: Path) -> None:
    version = "3.0" if b"instantiationToken" in _description(fmu) else "2.0"
    again = exported(tmp_path / "euclid.fmu", settled_line(LINE), version)
    assert again.read_bytes() == fmu.read_bytes()


def _description(fmu: Path) -> bytes:
    with zipfile.ZipFile(fmu) as archive:
        return archive.read("modelDescription.xml")
