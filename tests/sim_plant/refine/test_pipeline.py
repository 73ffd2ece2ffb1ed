"""The whole way from files: what is read, and how often."""

import numpy as np
import pytest

from benchmarks.campaign.line import declaration
from sim_plant.cli.main import main
from sim_plant.line import load
from sim_plant.line.declaration import Declaration
from sim_plant.line.open import make_line
from tests import quick_yaml

ROWS = 1200


@pytest.fixture
def files(tmp_path):
    """Write a line of which one number alone is not exact, a healthy record and its sidecar."""
    data = declaration() | {"tolerances": {"*": 0.0, "web.EA_N": 0.02}}
    line = Declaration.model_validate(data)
    speed, tension = np.linspace(0.9, 1.3, ROWS), np.full(ROWS, 89.0)
    run = make_line(line, seed=4, speed_m_s=0.9, tension_N=89.0)
    run.settle(10.0)
    out = run.simulate(speed, tension)
    columns = {
        "time_s": np.round(line.sample_time_s * np.arange(ROWS), 6),
        "line_speed_ref_m_s": speed,
        "tension_ref_N": tension,
    } | {s.channel: out[s.channel] for s in line.sensors}
    table = np.column_stack(list(columns.values()))
    np.savetxt(tmp_path / "a.csv", table, "%.9g", ",", header=",".join(columns), comments="")
    for name in ("line.yaml", "a.yaml"):
        (tmp_path / name).write_text(quick_yaml.safe_dump(data, sort_keys=False))
    return tmp_path


@pytest.mark.timeout(300)
def test_line_file_and_sidecar_are_each_parsed_once(files, monkeypatch, capsys):
    parsed, parse = [], load.parse_yaml

    def counting(text, file):
        parsed.append(file)
        return parse(text, file)

    monkeypatch.setattr(load, "parse_yaml", counting)
    arguments = [str(files / "line.yaml"), str(files / "a.csv"), "--workers", "1"]
    assert main(["refine", *arguments, "--out", str(files / "out")]) == 0
    assert sorted(parsed) == [str(files / "a.yaml"), str(files / "line.yaml")]
    said = capsys.readouterr().out
    assert "cannot be claimed: no held-out record" in said
    assert "verdict: nothing" in said
    assert (files / "out" / "verdict.json").exists()
