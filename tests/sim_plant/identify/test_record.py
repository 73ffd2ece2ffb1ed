"""Records are read whole or refused by file and column."""

from pathlib import Path

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.identify.record import read_record, refuse_clipped
from sim_plant.line.record_file import write_columns


@pytest.mark.parametrize("name", ["r.csv", "r.csv.gz"])
def test_columns_survive_a_round_trip(tmp_path: Path, name: str) -> None:
    write_columns(
        tmp_path / name, {"time_s": np.arange(3.0), "speed_rad_s": np.array([1.0, 2, 4])}
    )
    back = read_record(tmp_path / name, ["time_s", "speed_rad_s"])
    np.testing.assert_array_equal(back["speed_rad_s"], [1.0, 2.0, 4.0])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("time_s,a\n0,1\n1,2\n", "no column 'b'"),
        ("time_s,b\n0,1\n0,2\n", "must increase"),
        ("time_s,b\n0,1\n1,nan\n", "not finite"),
        ("time_s,b\n0,x\n1,2\n", "not a record"),
    ],
)
def test_wrong_files_are_refused_with_the_reason(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "r.csv"
    path.write_text(text, encoding="ascii")
    with pytest.raises(PlantError, match=message):
        read_record(path, ["time_s", "b"])


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(PlantError, match=r"absent\.csv: cannot be read \(No such file"):
        read_record(tmp_path / "absent.csv", [])


def test_a_coarse_resolution_alone_is_not_clipping() -> None:
    rng = np.random.default_rng(0)
    refuse_clipped("x", np.round(5.0 * np.sin(0.01 * np.arange(2000)) + 0.1 * rng.random(2000)))
