import threading
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.cli.main import main
from sim_plant.refine.records.read import read_record
from sim_plant.refine.records.recording import Recording
from sim_plant.refine.report.folder import FILES, check_apart, check_folder, publish
from sim_plant.refine.report.outcome import RefineRequest

LINE = "config/lines/euclid.yaml"


def plan(out, **more):
    given = {"line": out.parent / "line.yaml", "records": (), "holdout": ()}
    return RefineRequest(out=out, **(given | more))


def put(**texts):
    """Return a writer of files, by stem."""
    names = {name.split(".")[0]: name for name in FILES}
    return lambda into: [(into.out / names[k]).write_text(v) for k, v in texts.items()]


def test_results_of_an_earlier_run_do_not_stay_beside_a_new_verdict(tmp_path):
    out = tmp_path / "out"
    publish(plan(out), put(verdict="traced", aff_block="start: old", line_amended="old"))
    (out / "notes.txt").write_text("mine")
    publish(plan(out), put(verdict="nothing"))
    assert sorted(p.name for p in out.iterdir()) == ["notes.txt", "verdict.json"]
    assert (out / "verdict.json").read_text() == "nothing"


def test_a_writer_that_is_stopped_half_way_changes_nothing(tmp_path):
    out = tmp_path / "out"
    publish(plan(out), put(verdict="first", report="first"))

    def stopped(into):
        put(verdict="second")(into)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        publish(plan(out), stopped)
    assert sorted(p.name for p in out.iterdir()) == ["report.html", "verdict.json"]
    assert (out / "verdict.json").read_text() == "first"


def test_a_result_that_is_a_directory_is_refused_before_any_work(tmp_path):
    """Else the results before it are put in place, and those after it are not."""
    (tmp_path / "out" / "report.html").mkdir(parents=True)
    with pytest.raises(PlantError, match=r"its report\.html is a folder; take it away"):
        check_folder(plan(tmp_path / "out"))


def test_what_a_killed_run_has_left_is_taken_away(tmp_path):
    left = tmp_path / "out" / ".refine-abc"
    left.mkdir(parents=True)
    (left / "verdict.json").write_text("half")
    publish(plan(tmp_path / "out"), put(verdict="whole"))
    assert [p.name for p in (tmp_path / "out").iterdir()] == ["verdict.json"]


def test_a_second_run_waits_until_the_first_has_put_its_results_in_place(tmp_path):
    out, second = tmp_path / "out", []

    def slow(into):
        run = threading.Thread(target=publish, args=(plan(out), put(verdict="2")))
        run.start()
        second.append(run)
        run.join(0.3)
        assert not (out / "verdict.json").exists()
        put(verdict="1", aff_block="1")(into)

    publish(plan(out), slow)
    second[0].join(30.0)
    assert {p.name: p.read_text() for p in out.iterdir()} == {"verdict.json": "2"}


def test_links_in_a_circle_are_no_crash(tmp_path):
    (tmp_path / "r.csv").symlink_to(tmp_path / "r.csv")
    check_folder(plan(tmp_path / "out", records=(tmp_path / "r.csv",)))
    with pytest.raises(PlantError, match="cannot be read"):
        read_record(tmp_path / "r.csv")


def test_a_name_that_is_too_long_is_no_crash(tmp_path):
    check_folder(plan(tmp_path / ("o" * 300)))


def test_a_sidecar_that_would_be_overwritten_is_refused(tmp_path):
    with pytest.raises(PlantError, match=r"line_amended\.yaml: would be overwritten"):
        check_folder(plan(tmp_path, records=(tmp_path / "line_amended.csv",)))


def test_the_same_readings_packed_are_the_same_record():
    first, second = (
        Recording(path=tmp, sha256=str(tmp), sample_time_s=0.01, columns={"x_N": np.arange(9.0)})
        for tmp in (Path("r.csv"), Path("r.csv.gz"))
    )
    with pytest.raises(PlantError, match=r"r\.csv\.gz: is the same record as r\.csv"):
        check_apart([first], [second])
    other = replace(second, columns={"x_N": np.arange(9.0) + 1e-9})
    check_apart([first], [other])


def test_a_folder_that_a_directory_blocks_is_said_not_traced(tmp_path):
    (tmp_path / "out" / "verdict.json").mkdir(parents=True)
    with pytest.raises(PlantError, match=r"--out .*cannot be written"):
        publish(plan(tmp_path / "out"), put(verdict="x"))


@pytest.mark.parametrize("below", ["", "deeper/still"])
def test_a_file_in_the_way_is_refused_before_any_work(tmp_path, below):
    (tmp_path / "taken").write_text("mine")
    with pytest.raises(PlantError, match="taken is no folder; choose another --out"):
        check_folder(plan(tmp_path / "taken" / below))
    assert (tmp_path / "taken").read_text() == "mine"


def test_an_input_that_would_be_overwritten_is_refused(tmp_path):
    line = tmp_path / "line_amended.yaml"
    with pytest.raises(PlantError, match="would be overwritten"):
        check_folder(plan(tmp_path, line=line))


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["nope.yaml", "--example"], "nope.yaml: cannot be read"),
        ([LINE, "r.csv", "--example"], "--example makes its own records"),
        ([LINE, "--example", "--holdout", "r.csv"], "--example makes its own records"),
        ([LINE, "r.csv", "--workers", "0"], "--workers 0: give at least 1"),
        ([LINE], "give at least one RECORD"),
        ([LINE, "r.csv", "--without", "gremlins"], "--without gremlins: no such effect"),
    ],
)
def test_a_refused_command_writes_nothing(tmp_path, capsys, words, said):
    assert main(["refine", *words, "--out", str(tmp_path / "out")]) == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_an_example_into_a_file_is_refused(tmp_path, capsys):
    (tmp_path / "taken").write_text("mine")
    assert main(["refine", LINE, "--example", "--out", str(tmp_path / "taken")]) == 2
    assert "is no folder" in capsys.readouterr().err


def test_control_c_ends_with_a_word_and_code_130(monkeypatch, tmp_path, capsys):
    def stop(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("sim_plant.refine.example.line_in", stop)
    assert main(["refine", LINE, "--example", "--out", str(tmp_path / "out")]) == 130
    assert capsys.readouterr().err == "sim-plant: stopped\n"
    assert not (tmp_path / "out").exists()
