"""`sim-plant simulate` writes what the line does, and refuses what it cannot read."""

import gzip
from pathlib import Path

import numpy as np
import pytest

from sim_plant.cli.main import main
from sim_plant.line.record_file import read_columns

ROOT = Path(__file__).parents[3]
LINE = ROOT / "config" / "lines" / "euclid.yaml"


def test_a_record_holds_the_channels_and_its_references_give_the_same_run_again(tmp_path):
    first, again = tmp_path / "a.csv.gz", tmp_path / "b.csv.gz"
    base = ["simulate", str(LINE), "--exact"]
    assert main([*base, "--duration", "2", "--speed-m-s", "0.8", "--out", str(first)]) == 0
    assert main([*base, "--references", str(first), "--out", str(again)]) == 0
    assert gzip.decompress(first.read_bytes()) == gzip.decompress(again.read_bytes())
    columns = read_columns(first, ["time_s", "unwind_tension_N", "line_speed_m_s"])
    assert columns["time_s"].size == 400
    assert np.mean(columns["unwind_tension_N"]) == pytest.approx(88.9644, abs=0.01)
    assert np.mean(columns["line_speed_m_s"]) == pytest.approx(0.8, abs=1e-3)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("time_s,tension_ref_N\n0,1\n", "no column 'line_speed_ref_m_s'"),
        ("line_speed_ref_m_s,tension_ref_N\n1,nan\n", "not finite"),
        ("line_speed_ref_m_s,tension_ref_N\n1,x\n", "not a record"),
    ],
)
def test_references_that_cannot_be_used_are_refused_and_nothing_is_written(
    tmp_path, capsys, text, said
):
    record, out = tmp_path / "r.csv.gz", tmp_path / "o.csv.gz"
    record.write_bytes(gzip.compress(text.encode()))
    assert main(["simulate", str(LINE), "--references", str(record), "--out", str(out)]) == 2
    assert said in capsys.readouterr().err
    assert not out.exists()
