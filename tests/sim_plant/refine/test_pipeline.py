"""The whole way from files: what is read, and how often."""

import json
from dataclasses import asdict

import numpy as np
import pytest
from pydantic import TypeAdapter

from aff_runtime.base.refinement import Summary
from benchmarks.campaign.line import declaration
from sim_plant.cli.main import main
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.line.declared.declaration import Declaration
from sim_plant.line.open import make_line
from sim_plant.line.reading import load
from tests import quick_yaml

ROWS = 1200
LEFT_OUT = sorted(set(BY_NAME) - {"eccentric_roller", "web_modulus", "mains_hum"})
"""For time: what is found of all effects is another test's."""


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


@pytest.mark.long  # a whole refine; quick: on a short record, test_short_line.py
@pytest.mark.timeout(300)
def test_line_file_and_sidecar_are_each_parsed_once(files, monkeypatch, capsys):
    parsed, parse = [], load.parse_yaml

    def counting(text, file):
        parsed.append(file)
        return parse(text, file)

    monkeypatch.setattr(load, "parse_yaml", counting)
    arguments = [str(files / "line.yaml"), str(files / "a.csv"), "--workers", "1"]
    arguments += [part for name in LEFT_OUT for part in ("--without", name)]
    assert main(["refine", *arguments, "--out", str(files / "out")]) == 0
    assert sorted(parsed) == [str(files / "a.yaml"), str(files / "line.yaml")]
    said = capsys.readouterr().out
    assert "cannot be claimed: no held-out record" in said
    assert "verdict: nothing" in said
    assert (files / "out" / "verdict.json").exists()
    text = (files / "out" / "summary.json").read_text()
    told = json.loads(text)
    assert json.loads(json.dumps(asdict(TypeAdapter(Summary).validate_json(text)))) == told
    assert (told["kind"], told["held_out"], told["judged_on"]) == ("nothing", False, "a.csv")
    assert told["headline"].startswith("Nothing found")
    assert set(told["limits"]) <= {
        line.removeprefix("cannot be claimed: ") for line in said.splitlines()
    }
    error = next(row for row in told["errors"] if row["channel"] == "unwind_tension_N")
    verdict = json.loads((files / "out" / "verdict.json").read_text())
    assert error["unit"] == "N"
    assert error["after"] == verdict["residual_rms"]["unwind_tension_N"]["after"]


def test_what_records_lack_is_told_without_work_and_what_cannot_be_used_is_named(files, capsys):
    (files / "b.csv").write_text("time_s,unwind_tension_N\n0,1\n")
    arguments = [str(files / "line.yaml"), str(files / "a.csv"), "--holdout", str(files / "b.csv")]
    assert main(["refine", *arguments, "--lacking", "--out", str(files / "out")]) == 2
    assert sorted(path.name for path in (files / "out").iterdir()) == ["lacking.json"]
    first, second = json.loads((files / "out" / "lacking.json").read_text())["records"]
    assert (first["name"], first["refused"], first["is_held"]) == ("a.csv", "", False)
    assert first["speed_m_s"] == pytest.approx([0.9, 1.3])
    assert first["tension_N"] == [89.0, 89.0]
    assert first["length_s"] == pytest.approx(0.01 * ROWS)
    assert any("load cell" in text for text in first["lacks"])
    assert second["is_held"]
    assert "b.csv" in second["refused"]
    said = capsys.readouterr().out
    assert "b.csv: cannot be used" in said
    length = f"a.csv: {0.01 * ROWS:.1f} s to be fitted, 0.9 to 1.3 m/s, tension reference 89 N"
    assert length in said
    assert "  cannot be claimed: a wrong scale or zero of the load cell" in said
    assert "simulating" not in said


def test_a_record_given_twice_is_said_before_the_work(files):
    twice = [str(files / "a.csv"), "--holdout", str(files / "a.csv")]
    out = files / "out"
    arguments = [str(files / "line.yaml"), *twice, "--lacking", "--out", str(out)]
    assert main(["refine", *arguments]) == 2  # as the work itself would
    first, second = json.loads((out / "lacking.json").read_text())["records"]
    assert (first["refused"], second["is_held"]) == ("", True)
    assert "same record" in second["refused"]
