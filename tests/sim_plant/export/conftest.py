"""The Euclid line as an FMU: compiled once for all that only run it."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.made_once import made_once

LINE_FILE = Path(__file__).parents[3] / "config" / "lines" / "euclid.yaml"


@pytest.fixture(scope="session", params=["3.0", pytest.param("2.0", marks=pytest.mark.long)])
def fmu(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory, worker_id: str
) -> Path:
    """Return an FMU of the line; both versions are made of one source.

    The quick one compiles in a third of the time; its numbers are the same, and those of the
    kernel at -O1 too (``codegen/test_scalar.py``). The long one has the options that users get.
    """
    from benchmarks.fmu.beside import exported
    from sim_plant.export import binary
    from sim_plant.export.fmu import settled_line
    from sim_plant.line.reading.load import load_declaration

    def make(folder: Path) -> None:
        less = ("-Og",) if request.param == "3.0" else ()
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(binary, "OPTIONS", (*binary.OPTIONS, *less))
            line = settled_line(load_declaration(LINE_FILE))
            exported(folder / "euclid.fmu", line, request.param)

    folder = made_once(tmp_path_factory, worker_id, f"fmu {request.param}", make)
    return folder / "euclid.fmu"
